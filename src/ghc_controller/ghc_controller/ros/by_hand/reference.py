"""Send a task a target or a path from the command line and follow its status.

    ros2 run ghc_controller reference end_effector 0.5 0.1 0.7 --duration 2.0

Publishes   ghc/task_reference: one message, once a controller is found.
Subscribes  ghc/controller_state (current task value) and ghc/task_reference_status (reply).
Exit code   0 REACHED; 1 REJECTED, REPLACED or not reached in time; 2 wrong arguments; 130 Ctrl-C.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rclpy.utilities import remove_ros_args

from ghc_controller.errors import ConfigurationError
from ghc_controller.references.point_files import read_points
from ghc_controller.ros.by_hand.follow import add_timing, complain, follow, show
from ghc_controller.ros.by_hand.move import Move
from ghc_controller.ros.by_hand.reference_request import NODE_NAME, ReferenceRequest
from ghc_controller.ros.run import EXIT_REFUSED


def main(arguments: Sequence[str] | None = None) -> int:
    """Publish one reference and follow it until it is reached."""
    given = list(sys.argv if arguments is None else [NODE_NAME, *arguments])
    parser = _parser()
    options = parser.parse_args(remove_ros_args(given)[1:])
    target = [*options.position, *(options.quaternion or ()), *(options.wrench or ())]
    if bool(target) == bool(options.file):
        parser.error("a target or --file expected, and not both")
    if options.file and (options.duration or options.velocity):
        parser.error("--duration and --velocity are for a target: a file has its own times")
    try:
        path = read_points(options.file) if options.file else _move(options)
    except ConfigurationError as error:
        return complain(NODE_NAME, str(error), EXIT_REFUSED)

    def create() -> ReferenceRequest:
        return ReferenceRequest(options.task, path, options.start, options.tolerance, show)

    return follow(NODE_NAME, given, create, options.timeout)


def _move(options: argparse.Namespace) -> Move:
    return Move(
        tuple(options.position),
        tuple(options.quaternion or ()),
        tuple(options.wrench or ()),
        options.duration,
        options.velocity,
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=NODE_NAME, description="Give a task of the running controller a target or a path."
    )
    parser.add_argument("task", help="name of the task, as in robot.yaml")
    parser.add_argument(
        "position",
        nargs="*",
        type=float,
        help="one number per row: [m] in the axes of the world, or [rad] of a posture's joints",
    )
    parser.add_argument(
        "--quaternion",
        nargs=4,
        type=float,
        metavar=("X", "Y", "Z", "W"),
        help="orientation, of any length; for a pose after its position",
    )
    parser.add_argument(
        "--wrench",
        nargs="+",
        type=float,
        metavar="N",
        help="[N], [Nm] to exert on the environment, one number per row, under force control",
    )
    parser.add_argument(
        "--file", type=Path, help="follow the points of a .csv or .yaml file (docs/running.md)"
    )
    timed = parser.add_mutually_exclusive_group()
    timed.add_argument(
        "--duration",
        type=_positive,
        default=0.0,
        metavar="SECONDS",
        help="of a minimum-jerk move from the current reference (default: at once)",
    )
    timed.add_argument(
        "--velocity",
        type=_positive,
        default=0.0,
        metavar="M_PER_S",
        help="largest speed of such a move, [m/s] or [rad/s], instead of its duration",
    )
    parser.add_argument(
        "--tolerance",
        type=_positive,
        default=1e-3,
        metavar="M",
        help="error at which it is reached, [m] or [rad] (default: 0.001)",
    )
    add_timing(parser, "move")
    return parser


def _positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} given, a number above 0 expected")
    return value


if __name__ == "__main__":
    sys.exit(main())

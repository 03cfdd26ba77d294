"""Request a priority transition from the command line and follow its status.

    ros2 run ghc_controller transition 'elbow > end_effector > posture' --duration 2.0

Publishes   ghc/priority_transition: one message, once a controller is found.
Subscribes  ghc/priority_matrix (prints the current hierarchy) and ghc/transition_status (prints
            each status of the request as it arrives).
Exit code   0 DONE; 1 REJECTED, PREEMPTED or no answer in time; 2 wrong arguments; 130 Ctrl-C.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence

from ghc_msgs.msg import PriorityMatrix, PriorityTransition, TransitionStatus
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from ghc_controller.hierarchy import Profile
from ghc_controller.ros.by_hand.follow import add_timing, follow, line, show, where_controllers_are
from ghc_controller.ros.qos import LATCHED_QOS, RELIABLE_QOS
from ghc_controller.ros.run import EXIT_FAILED
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.types import NANOSECONDS

NODE_NAME = "transition"
_DURATION = 2.0  # [s] default duration of a ramp
_WORDS = {
    getattr(TransitionStatus, word): word
    for word in ("ACCEPTED", "REJECTED", "ACTIVE", "DONE", "PREEMPTED")
}
_EXIT_CODES = {
    TransitionStatus.DONE: 0,
    TransitionStatus.REJECTED: EXIT_FAILED,
    TransitionStatus.PREEMPTED: EXIT_FAILED,
}


class TransitionRequest:
    """One request and the statuses that carry its id."""

    def __init__(self, request: PriorityTransition, show: Callable[[str], None]) -> None:
        self.node = Node(NODE_NAME)
        self.sent = False
        self.exit_code: int | None = None  # None while the request is pending
        self._request = request
        self._show = show
        self._publisher = self.node.create_publisher(
            PriorityTransition, "ghc/priority_transition", RELIABLE_QOS
        )
        self.node.create_subscription(
            TransitionStatus, "ghc/transition_status", self._on_status, RELIABLE_QOS
        )
        # Created last: once its latched message arrives, the controller knows the publisher above.
        self.node.create_subscription(
            PriorityMatrix, "ghc/priority_matrix", self._on_matrix, LATCHED_QOS
        )
        self._in_force: PriorityMatrix | None = None

    def send_when_heard(self) -> None:
        """Send the request once, when a controller can receive it and reply."""
        matrix = self._in_force
        if self.sent or matrix is None or self._publisher.get_subscription_count() == 0:
            return
        self._show(line(matrix.header.stamp, "current", matrix.hierarchy or "a matrix"))
        self._publisher.publish(self._request)
        self.sent = True

    def missing(self) -> str:
        """What has not happened yet."""
        if self.sent:
            return "the transition did not end"
        elsewhere = where_controllers_are(self.node, "ghc/priority_matrix")
        if elsewhere:
            return f"no ghc/priority_matrix{elsewhere} none came"
        return "no ghc/priority_matrix: no controller, or one without joint_states,"

    def _on_matrix(self, message: PriorityMatrix) -> None:
        self._in_force = message

    def _on_status(self, message: TransitionStatus) -> None:
        if message.id == self._request.id:
            self._show(status_line(message))
            self.exit_code = _EXIT_CODES.get(message.status)


def status_line(message: TransitionStatus) -> str:
    """Status and its details."""
    detail = message.hierarchy
    if message.status == TransitionStatus.REJECTED:
        detail = message.reason
    elif message.status == TransitionStatus.ACCEPTED:
        start = nanoseconds_from_time(message.start) / NANOSECONDS
        detail += f", from t = {start:.3f} s over {message.duration:g} s"
        if message.torque_rate:
            detail += f" or longer, at most {message.torque_rate:g} Nm/s"
    return line(message.header.stamp, _WORDS.get(message.status, "?"), detail)


def main(arguments: Sequence[str] | None = None) -> int:
    """Publish one transition and follow it to its end."""
    given = list(sys.argv if arguments is None else [NODE_NAME, *arguments])
    options = _parser().parse_args(remove_ros_args(given)[1:])
    request = PriorityTransition(
        id=f"{NODE_NAME}_{os.getpid()}",
        hierarchy=options.hierarchy,
        duration=_duration(options),
        torque_rate=options.torque_rate,
        profile=options.profile,
    )
    request.header.stamp = time_from_seconds(options.start)
    return follow(NODE_NAME, given, lambda: TransitionRequest(request, show), options.timeout)


def _parser() -> argparse.ArgumentParser:
    profiles = [profile.value for profile in Profile]
    parser = argparse.ArgumentParser(
        prog=NODE_NAME, description="Change the priorities of the running controller."
    )
    parser.add_argument(
        "hierarchy", help="such as 'a > b = c': > strict, = equal; a task left out is removed"
    )
    parser.add_argument(
        "--duration",
        type=float,
        metavar="SECONDS",
        help="of the ramp (default: 2; 0 with --torque-rate)",
    )
    parser.add_argument(
        "--torque-rate",
        type=float,
        default=0.0,
        metavar="NM_PER_S",
        help="that the ramp may add to any joint: it takes as long as this asks (default: any)",
    )
    parser.add_argument("--profile", choices=profiles, default=profiles[0])
    add_timing(parser, "ramp")
    return parser


def _duration(options: argparse.Namespace) -> float:
    """Given duration [s], or the default: 0 with a torque-rate budget."""
    if options.duration is not None:
        return float(options.duration)
    return 0.0 if options.torque_rate else _DURATION


if __name__ == "__main__":
    sys.exit(main())

"""Change gains, weights, limits or the formulation of the running controller.

    ros2 run ghc_controller tune tasks.elbow.stiffness 60 regularization 0.02

Calls       controller/set_parameters_atomically: all of them or none; `ros2 param set` does the
            same for one.
Exit code   0 SET; 1 REJECTED or no answer in time; 2 wrong arguments; 130 Ctrl-C.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import yaml
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from rclpy.utilities import remove_ros_args

from ghc_controller.ros.by_hand.follow import follow, show
from ghc_controller.ros.run import EXIT_FAILED

NODE_NAME = "tune"
SERVICE = "controller/set_parameters_atomically"


class TuneRequest:
    """One set of parameters, and the reply."""

    def __init__(self, values: Mapping[str, Any], show: Callable[[str], None]) -> None:
        self.node = Node(NODE_NAME)
        self.exit_code: int | None = None  # None while the request is pending
        self._values, self._show = values, show
        self._client = self.node.create_client(SetParametersAtomically, SERVICE)
        self._sent = False

    def send_when_heard(self) -> None:
        """Send the request once, when a controller is found."""
        if self._sent or not self._client.service_is_ready():
            return
        self._sent = True
        parameters = [
            Parameter(name, value=value).to_parameter_msg() for name, value in self._values.items()
        ]
        request = SetParametersAtomically.Request(parameters=parameters)
        self._client.call_async(request).add_done_callback(self._on_answer)

    def missing(self) -> str:
        """What did not happen yet."""
        return "no answer of the controller" if self._sent else f"no {SERVICE}: no controller"

    def _on_answer(self, future: Future) -> None:
        result = future.result().result
        words = ", ".join(f"{name} {value}" for name, value in self._values.items())
        self._show(f"SET {words}" if result.successful else f"REJECTED {result.reason}")
        self.exit_code = 0 if result.successful else EXIT_FAILED


def main(arguments: Sequence[str] | None = None) -> int:
    """Set parameters of the controller and print its reply."""
    given = list(sys.argv if arguments is None else [NODE_NAME, *arguments])
    parser = _parser()
    options = parser.parse_args(remove_ros_args(given)[1:])
    pairs = options.pairs
    if len(pairs) % 2:
        parser.error(f"names and values in turn expected, {len(pairs)} words given")
    try:
        values = {name: _value(text) for name, text in zip(pairs[::2], pairs[1::2], strict=True)}
    except ValueError as error:
        parser.error(str(error))
    return follow(NODE_NAME, given, lambda: TuneRequest(values, show), options.timeout)


def _value(text: str) -> Any:
    """Number, list of numbers, true or false, or a text, as `ros2 param set` reads them."""
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        value = None
    if isinstance(value, list):
        try:
            return [float(number) for number in value]
        except (TypeError, ValueError):
            value = None
    if not isinstance(value, bool | int | float | str):
        raise ValueError(f"'{text}' given; a number, a list of numbers, true, false or a name")
    return value


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=NODE_NAME, description="Change parameters of the running controller by a blend."
    )
    parser.add_argument(
        "pairs",
        nargs="+",
        metavar="NAME VALUE",
        help='such as tasks.hand.stiffness 60, or "[60, 60, 40]" for each row',
    )
    parser.add_argument(
        "--timeout",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="wall time until the answer (default: 60)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())

"""Priorities that follow a distance: ramps between two orders, renewed as the distance changes.

Publishes  ghc/priority_transition (at the rate of ghc/controller_state while the share moves),
           /diagnostics.
Subscribes ghc/controller_state (the error that is followed, and the mixture in force).
Parameters see PriorityShareParameters.

It acts while the controller is in one of its two orders or between them. If another request
leaves them it waits until one of them is in force again.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence

from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import ControllerState, PriorityTransition
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.task import Future

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.hierarchy.distance_share import DistanceShare, ShareFollower
from ghc_controller.hierarchy.hierarchy_string import parse_levels
from ghc_controller.ros.conversions.common import diagnostics_message
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import RELIABLE_QOS, STREAM_QOS
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import run_node, tolerant
from ghc_controller.ros.shares.parameters import PriorityShareParameters
from ghc_controller.ros.time import nanoseconds_from_time

NODE_NAME = "priority_share"
STATE = "ghc/controller_state"
_DIAGNOSTICS_PERIOD = 1.0  # [s] wall

Levels = tuple[frozenset[str], ...]


class PriorityShareNode:
    """Wires topics to ShareFollower."""

    def __init__(self, stop: Future) -> None:  # noqa: ARG002 - no message ends it
        """Read the parameters and subscribe; ConfigurationError if they cannot be used."""
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._parameters = p = read_parameters(self.node, PriorityShareParameters)
        self.executor = p.executor
        try:
            self._orders = tuple(_levels(text) for text in (p.first, p.second))
            share = DistanceShare(p.begins, p.ends, p.lag, p.full_way)
        except InvalidValue as error:
            raise ConfigurationError(str(error)) from error
        if self._orders[0] == self._orders[1]:
            raise ConfigurationError(f"first and second: two orders expected, '{p.first}' given")
        self._follower = ShareFollower(share)
        self._rejections = Rejections()
        self._summary, self._share, self._sent, self._now_ns = "no controller_state", 0.0, 0, -1
        self._out = self.node.create_publisher(
            PriorityTransition, "ghc/priority_transition", RELIABLE_QOS
        )
        self._diagnostics = self.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        take: Callable[[ControllerState], None] = tolerant(self._on_state, STATE, self._reject)
        self.node.create_subscription(ControllerState, STATE, take, STREAM_QOS)
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(_DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=wall)
        self.node.get_logger().info(f"share of '{p.second}' by the error of {p.task}: ready")

    def _on_state(self, message: ControllerState) -> None:
        self._now_ns = nanoseconds_from_time(message.header.stamp)
        try:
            value = self._error(message)
        except UnknownName as error:
            self._say(str(error))
            return
        share = self._share_of(message)
        if share is None:
            self._say("waiting: another order is in force")
            return
        self._share = share
        self._say("following")
        move = self._follower.next(share, value)
        if move is None:
            return
        p = self._parameters
        self._out.publish(
            PriorityTransition(
                id=NODE_NAME,
                hierarchy=p.second if move.to_second else p.first,
                duration=move.duration,
                torque_rate=p.torque_rate,
                profile="linear",
            )
        )
        self._sent += 1

    def _error(self, message: ControllerState) -> float:
        """Error of the task: that of its row with its sign, or the norm of several."""
        for task in message.tasks:
            if task.name == self._parameters.task:
                return float(task.error[0] if len(task.error) == 1 else task.error_norm)
        raise UnknownName("task", self._parameters.task, [task.name for task in message.tasks])

    def _share_of(self, message: ControllerState) -> float | None:
        """Share of the second order; None if any other order has one."""
        share = 0.0
        for text, part in zip(message.mixture, message.shares, strict=True):
            levels = _levels(text) if text else ()
            if levels not in self._orders:
                return None
            share += part if levels == self._orders[1] else 0.0
        return min(share, 1.0)

    def _reject(self, field: str, reason: str) -> None:
        if self._rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(f"{field}: {reason}")

    def _say(self, summary: str) -> None:
        if summary != self._summary:
            self._summary = summary
            self.node.get_logger().info(summary)

    def _publish_diagnostics(self) -> None:
        rejected = {f"rejected_{field}": n for field, n in self._rejections.counts.items()}
        values = {"share": round(self._share, 4), "requests": self._sent, **rejected}
        stands = self._summary != "following"
        self._diagnostics.publish(
            diagnostics_message(max(self._now_ns, 0), NODE_NAME, self._summary, stands, values)
        )

    def close(self) -> None:
        """No resources to release."""


def _levels(hierarchy: str) -> Levels:
    return tuple(frozenset(level) for level in parse_levels(hierarchy))


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, PriorityShareNode, args)


if __name__ == "__main__":
    sys.exit(main())

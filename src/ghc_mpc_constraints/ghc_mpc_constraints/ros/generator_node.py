"""ROS node of a constraint generator: receives raw input, publishes previews at each tick.

Publishes  constraints/preview (stamp and epoch of the tick), /diagnostics.
Subscribes ghc/tick (when to plan), sim_bridge/epoch (latched), the input that the generator
           declares, ghc/controller_state (current bounds, before the first preview).
Parameters `generator`: its name; and those of `parameters_of` that generator.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import ConstraintPreviews, ControllerState, Tick
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.task import Future

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.conversions.previews import previews_message
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.previews import PREVIEW_TOPIC
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, PREVIEW_QOS, STREAM_QOS
from ghc_controller.ros.rejections import GENERATOR, Rejections, warning
from ghc_controller.ros.run import run_node, tolerant
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.ros.wire.cdr import decode_tick
from ghc_controller.ros.wire.epochs import listen_to_epochs
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.generator import GENERATORS, Generator
from ghc_mpc_constraints.ros.diagnostics import GeneratorDiagnostics
from ghc_mpc_constraints.ros.early_messages import EarlyMessages
from ghc_mpc_constraints.ros.inputs import make_input
from ghc_mpc_constraints.ros.parameters import parameters_of
from ghc_mpc_constraints.ros.take_over import TakeOver
from ghc_mpc_constraints.ros.tick_clock import Due, TickClock

DIAGNOSTICS_PERIOD = 1.0  # [s] wall
NODE_NAME = "generator"


class GeneratorNode:
    """Plans once per tick; repeats the previews of a repeated tick.

    The controller announces ticks on ghc/tick, ahead of the states that need their previews.
    """

    def __init__(
        self,
        stop: Future,  # noqa: ARG002 - no message stops it
        name: str = "",
    ) -> None:
        """Read the parameters, create the generator, subscribe.

        Args:
            name: of the generator; "" = value of the parameter `generator`.

        Raises:
            GhcError: a parameter is invalid, or there is no such generator.
        """
        self._name = name or _chosen()
        kind = GENERATORS[self._name]
        self.node = Node(self._name, automatically_declare_parameters_from_overrides=True)
        if self.node.has_parameter("generator"):
            self.node.undeclare_parameter("generator")
        p = read_parameters(self.node, parameters_of(kind))
        self.executor = p.executor
        self._clock = TickClock(round(p.settings.step * NANOSECONDS))
        self._rejections = Rejections()
        self._generator: Generator = kind(p.settings)
        self._input = make_input(self._generator, p, self._clock, self._reject)
        self._early = EarlyMessages(self._clock)
        self._take_over = TakeOver(self._generator, self._input, p.take_over_timeout, self._reject)
        self._report = GeneratorDiagnostics(
            self._name, self._generator, self._input, self._rejections, p.settings.smoothing
        )
        self._held_back_ns: int | None = None  # tick [ns] waiting for an input
        self._message = ConstraintPreviews()
        self._listen()
        horizon = self._generator.horizon
        self.node.get_logger().info(
            f"{horizon.steps} steps of {horizon.step:g} s, smoothing "
            f"{'on' if p.settings.smoothing else 'off'}: ready"
        )

    def close(self) -> None:
        """No resources to release."""

    def _listen(self) -> None:
        node, given = self.node, self._input
        self._previews = node.create_publisher(ConstraintPreviews, PREVIEW_TOPIC, PREVIEW_QOS)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._subscribe(given.message, given.topic, self._on_input, given.qos)
        self._controller: Subscription | None = self._subscribe(
            ControllerState, "ghc/controller_state", self._take_over.hear, STREAM_QOS, True
        )
        listen_to_epochs(self.node, self._clock.timeline, self._reject)
        self._subscribe(Tick, "ghc/tick", self._on_tick, CONTROL_SUBSCRIBER_QOS, True)
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=wall)

    def _subscribe(
        self,
        kind: type[Any],
        topic: str,
        handle: Callable[[Any], None],
        qos: QoSProfile,
        raw: bool = False,
    ) -> Subscription:
        """Subscribe; a message whose handling raises is rejected and counted."""
        return self.node.create_subscription(
            kind, topic, tolerant(handle, topic, self._reject), qos, raw=raw
        )

    def _reject(self, field: str, reason: str) -> None:
        """Count a rejection, with a rate-limited warning."""
        if self._rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(warning(field, reason, GENERATOR))

    def _on_input(self, message: Any) -> None:
        take = tolerant(self._take, self._input.topic, self._reject)  # also for queued messages
        self._early.after_first_tick(partial(take, message), self._input.newest_only)

    def _take(self, message: Any) -> None:
        stamp_ns = nanoseconds_from_time(message.header.stamp)
        if self._early.wait_for_run_of(stamp_ns, partial(self._on_input, message)):
            return
        if self._input.take(message):  # plan the waiting tick, or the last one if it is repeated
            self._clock.forget()
            if self._held_back_ns is not None:
                self._try_tick(self._held_back_ns)

    def _on_tick(self, data: bytes) -> None:
        try:
            stamp_ns, epoch = decode_tick(data)
        except ValueError as error:
            self._reject("ghc/tick", str(error))
            return
        due = self._clock.judge(stamp_ns, epoch)
        if self._clock.new_epoch:  # previews and inputs of the new run have its stamps
            self._generator.reset()
            self._input.forget()
            self._held_back_ns = None  # of the run before
            self._early.begin_run()
        if due in (Due.STALE, Due.IMPLAUSIBLE):
            self._reject(
                "ghc/tick.start",
                f"{stamp_ns / NANOSECONDS:.6f} s of epoch {epoch} given, "
                f"{self._clock.timeline.expected()}",
            )
            return
        self._early.begin_ticks()
        if due is Due.REPEAT:
            self._previews.publish(self._message)
        elif due is Due.PLAN:
            self._try_tick(stamp_ns)

    def _try_tick(self, stamp_ns: int) -> None:
        """Plan the tick of a stamp unless an input is missing."""
        start_ns = self._clock.start_of(stamp_ns)
        self._held_back_ns = stamp_ns
        run_ns = self._clock.timeline.start_ns or 0
        if not self._input.ready(start_ns) or self._take_over.waits(start_ns, run_ns):
            return
        begun = time.perf_counter()
        self._plan(start_ns)
        self._clock.planned(stamp_ns)
        self._held_back_ns = None
        self._take_over.end()
        if self._controller is not None:  # each status message would wake this node
            self.node.destroy_subscription(self._controller)
            self._controller = None
        self._report.ticked(time.perf_counter() - begun)

    def _plan(self, start_ns: int) -> None:
        """Compute and publish the previews of a tick."""
        now = start_ns / NANOSECONDS
        self._input.begin(now)
        previews = tuple(
            preview.labeled(preview.kind, preview.stale, preview.name or self._name)
            for preview in self._generator.previews(now)
        )
        self._message = previews_message(previews, start_ns, self._clock.epoch)
        self._previews.publish(self._message)

    def _publish_diagnostics(self) -> None:
        self._diagnostics.publish(self._report.report(self._clock.now_ns))


def _chosen() -> str:
    """Value of the parameter `generator`.

    Raises:
        InvalidValue: it is empty.
    """
    probe = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
    try:
        given = probe.get_parameter_or("generator").value
    finally:
        probe.destroy_node()
    if not isinstance(given, str) or not given:
        known = ", ".join(GENERATORS)
        raise InvalidValue(f"parameter 'generator': nothing given, one of {known} expected")
    return given


def main(args: Sequence[str] | None = None, name: str = "") -> int:
    """Run the node until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(name or NODE_NAME, partial(GeneratorNode, name=name), args)


def contact_force_bounds(args: Sequence[str] | None = None) -> int:
    """Run the generator of contact forces under its previous name."""
    return main(args, "contact_force_bounds")


def obstacle_bounds(args: Sequence[str] | None = None) -> int:
    """Run the generator of obstacle motion under its previous name."""
    return main(args, "obstacle_bounds")


if __name__ == "__main__":
    sys.exit(main())

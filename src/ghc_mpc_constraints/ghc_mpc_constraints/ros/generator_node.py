"""A constraint generator behind ROS topics: raw input in, previews of its constraint each tick.

Publishes  constraints/preview (stamp and epoch of the tick), /diagnostics.
Subscribes ghc/tick (when to plan), sim_bridge/epoch (latched), the input that the generator
           declares, ghc/controller_state (what is in force, before the first preview).
Parameters `generator`: which one; and those of `parameters_of` that generator.
"""

from __future__ import annotations

import sys
import time
from collections import deque
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
from ghc_controller.ros.conversions.common import diagnostics_message
from ghc_controller.ros.conversions.previews import previews_message
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.previews import PREVIEW_TOPIC
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, PREVIEW_QOS, STREAM_QOS
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import run_node, tolerant
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.ros.wire.cdr import decode_tick
from ghc_controller.ros.wire.epochs import listen_to_epochs
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.generator import GENERATORS, Generator
from ghc_mpc_constraints.ros.conversions import in_force
from ghc_mpc_constraints.ros.inputs import make_input
from ghc_mpc_constraints.ros.parameters import parameters_of
from ghc_mpc_constraints.ros.tick_clock import Due, TickClock

DIAGNOSTICS_PERIOD = 1.0  # [s] wall
MOST_EARLY = 1000  # [-] messages that wait for the run to which they belong
NODE_NAME = "generator"


class GeneratorNode:
    """Plans once a tick, answers a repeated tick with the same previews.

    The controller announces ticks on ghc/tick, ahead of the states that need their previews.

    A generator that starts while the robot's time is running goes on from the bounds in force,
    which the controller's state carries; it waits for that message, but not for long.
    """

    def __init__(
        self,
        stop: Future,  # noqa: ARG002 - no message ends it
        name: str = "",
    ) -> None:
        """Read the parameters, make the generator, listen.

        Args:
            name: of the generator; "" = of the parameter `generator`.

        Raises:
            GhcError: a parameter cannot be used, or there is no such generator.
        """
        self._name = name or _chosen()
        kind = GENERATORS[self._name]
        self.node = Node(self._name, automatically_declare_parameters_from_overrides=True)
        if self.node.has_parameter("generator"):
            self.node.undeclare_parameter("generator")
        self.parameters = read_parameters(self.node, parameters_of(kind))
        self.executor = self.parameters.executor
        self.clock = TickClock(round(self.parameters.settings.step * NANOSECONDS))
        self.rejections = Rejections()
        self._early: list[Callable[[], None]] = []  # what came before the first tick
        self._next_run: deque[Callable[[], None]] = deque(maxlen=MOST_EARLY)
        self._in_force: list[bytes] = []  # the last two controller_states, until the first plan
        self._waiting_since: float | None = None  # [s] wall
        self._held_back_ns: int | None = None  # tick [ns] that waits for an input
        self._started = False  # a plan has been made
        self._tick_time = 0.0  # [s] wall, longest since the last diagnostics
        self._generator: Generator = kind(self.parameters.settings)
        self._input = make_input(self._generator, self.parameters, self.clock, self.reject)
        self._message = ConstraintPreviews()
        self._listen()
        horizon = self._generator.horizon
        self.node.get_logger().info(
            f"{horizon.steps} steps of {horizon.step:g} s, smoothing "
            f"{'on' if self.parameters.settings.smoothing else 'off'}: ready"
        )

    def _listen(self) -> None:
        node, given = self.node, self._input
        self._previews = node.create_publisher(ConstraintPreviews, PREVIEW_TOPIC, PREVIEW_QOS)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.listen(given.message, given.topic, self._on_input, given.qos)
        self._controller: Subscription | None = self.listen(
            ControllerState, "ghc/controller_state", self._on_controller, STREAM_QOS, True
        )
        listen_to_epochs(self.node, self.clock.timeline, self.reject)
        self.listen(Tick, "ghc/tick", self._on_tick, CONTROL_SUBSCRIBER_QOS, True)
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=wall)

    def plan(self, start_ns: int) -> None:
        """Make the previews of a tick and publish them."""
        now = start_ns / NANOSECONDS
        self._input.begin(now)
        previews = tuple(
            preview.labeled(preview.kind, preview.stale, preview.name or self._name)
            for preview in self._generator.previews(now)
        )
        self._message = previews_message(previews, start_ns, self.clock.epoch)
        self._previews.publish(self._message)

    def reset(self) -> None:
        """Forget previews and inputs: those of the new run carry its stamps."""
        self._generator.reset()
        self._input.forget()

    def take_over(self, states: Sequence[bytes], start_ns: int) -> bool:
        """Start from what the newest serialized ControllerStates, one or two, say is in force.

        False when inputs are missing without which there would be nothing to plan for them.
        """
        found = in_force(states, start_ns / NANOSECONDS, self._generator.kind)
        self._generator.take_over(found)
        return self._input.can_take_over(found)

    def _on_input(self, message: Any) -> None:
        self.after_first_tick(partial(self._take, message), self._input.newest_only)

    def _take(self, message: Any) -> None:
        stamp_ns = nanoseconds_from_time(message.header.stamp)
        if self._waits_for_next_run(stamp_ns, partial(self._take, message)):
            return
        if self._input.take(message):
            self.look_again()

    def listen(
        self,
        kind: type[Any],
        topic: str,
        handle: Callable[[Any], None],
        qos: QoSProfile,
        raw: bool = False,
    ) -> Subscription:
        """Subscribe; a message whose handling raises is rejected and counted."""
        return self.node.create_subscription(
            kind, topic, tolerant(handle, topic, self.reject), qos, raw=raw
        )

    def after_first_tick(self, handle: Callable[[], None], newest_only: bool = False) -> None:
        """Do it now, or as soon as the robot's time is known."""
        if self.clock.now_ns < 0:
            if newest_only:
                self._early.clear()
            self._early.append(handle)
        else:
            handle()

    def _waits_for_next_run(self, stamp_ns: int, handle: Callable[[], None]) -> bool:
        """Whether a stamp [ns] is of a run that has not begun; then it is done when it begins."""
        if not self.clock.timeline.is_of_next_run(stamp_ns):
            return False
        self._next_run.append(handle)
        return True

    def reject(self, field: str, reason: str) -> None:
        """Count a refusal, and say so once in a while."""
        if self.rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(f"{field}: {reason}")

    def look_again(self) -> None:
        """An input came: plan the tick that waits for it, or the last one when it is repeated."""
        self.clock.forget()
        if self._held_back_ns is not None:
            self._try_tick(self._held_back_ns)

    def close(self) -> None:
        """No resources to release."""

    def _on_controller(self, data: bytes) -> None:
        if not self._started:
            self._in_force = [*self._in_force[-1:], data]

    def _on_tick(self, data: bytes) -> None:
        try:
            stamp_ns, epoch = decode_tick(data)
        except ValueError as error:
            self.reject("ghc/tick", str(error))
            return
        due = self.clock.judge(stamp_ns, epoch)
        if self.clock.new_epoch:
            self.reset()
            early = list(self._next_run)
            self._next_run.clear()
            for handle in early:
                handle()
        if self._early and due not in (Due.STALE, Due.IMPLAUSIBLE):
            for handle in self._early:
                handle()
            self._early.clear()
        if due is Due.REPEAT:
            self._previews.publish(self._message)
        elif due is Due.PLAN:
            self._try_tick(stamp_ns)
        elif due in (Due.STALE, Due.IMPLAUSIBLE):
            self.reject(
                "ghc/tick.start",
                f"{stamp_ns / NANOSECONDS:.6f} s of epoch {epoch} given, "
                f"{self.clock.timeline.expected()}",
            )

    def _try_tick(self, stamp_ns: int) -> None:
        """Plan the tick of a stamp unless something is still to come."""
        start_ns = self.clock.start_of(stamp_ns)
        self._held_back_ns = stamp_ns
        if not self._input.ready(start_ns) or self._waits_to_take_over(start_ns):
            return
        begun = time.perf_counter()
        self.plan(start_ns)
        self.clock.planned(stamp_ns)
        self._held_back_ns = None
        self._started = True
        self._in_force.clear()
        if self._controller is not None:  # it would wake this node at every status
            self.node.destroy_subscription(self._controller)
            self._controller = None
        self._tick_time = max(self._tick_time, time.perf_counter() - begun)

    def _waits_to_take_over(self, start_ns: int) -> bool:
        """Before the first plan of a run under way: wait for the bounds in force, use them."""
        if self._started or start_ns == (self.clock.timeline.start_ns or 0):
            return False
        if self._in_force and self.take_over(self._in_force, start_ns):
            return False
        if self._waiting_since is None:
            self._waiting_since = time.monotonic()
        return time.monotonic() - self._waiting_since < self.parameters.take_over_timeout

    def _publish_diagnostics(self) -> None:
        generator = self._generator
        trouble = sum(generator.counts[name] for name in generator.TROUBLE)
        more = {"second_opinions": generator.second_opinions, **self._input.counts}
        counts: dict[str, int] = {**generator.counts, **more}
        refused = sum(self.rejections.counts.values())
        summary = "ok" if self.clock.now_ns >= 0 else "waiting for ghc/tick"
        if trouble or refused:
            summary = f"{trouble} plans without a solution or inputs in doubt, {refused} refused"
        values: dict[str, object] = {"longest_tick_ms": round(1e3 * self._tick_time, 3)}
        values |= {"smoothing": self.parameters.settings.smoothing, **counts}
        values |= {f"rejected_{k}": n for k, n in sorted(self.rejections.counts.items())}
        self._tick_time = 0.0
        self._diagnostics.publish(
            diagnostics_message(
                max(self.clock.now_ns, 0), self._name, summary, bool(trouble or refused), values
            )
        )


def _chosen() -> str:
    """Value of the parameter `generator`.

    Raises:
        InvalidValue: none was given.
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
    """Run the generator of contact forces under its older name."""
    return main(args, "contact_force_bounds")


def obstacle_bounds(args: Sequence[str] | None = None) -> int:
    """Run the generator of obstacle motion under its older name."""
    return main(args, "obstacle_bounds")


if __name__ == "__main__":
    sys.exit(main())

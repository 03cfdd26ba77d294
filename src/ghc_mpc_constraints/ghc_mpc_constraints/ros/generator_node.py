"""What both generator nodes share: the controller's ticks, repeats, taking over."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Generic, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import ControllerState, Tick
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.task import Future

from ghc_controller.ros.conversions.common import diagnostics_message
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, STREAM_QOS
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import tolerant
from ghc_controller.ros.wire.cdr import decode_tick
from ghc_controller.ros.wire.epochs import listen_to_epochs
from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.ros.parameters import ForceBoundParameters, ObstacleParameters
from ghc_mpc_constraints.ros.tick_clock import Due, TickClock

P = TypeVar("P", ForceBoundParameters, ObstacleParameters)

DIAGNOSTICS_PERIOD = 1.0  # [s] wall
MOST_EARLY = 1000  # [-] messages that wait for the run to which they belong


class GeneratorNode(ABC, Generic[P]):
    """Plans once a tick, answers a repeated tick with the same plan.

    The controller announces ticks on ghc/tick, ahead of the states that need their plans.

    A generator that starts while the robot's time is running goes on from the bounds in force,
    which the controller's state carries; it waits for that message, but not for long.
    """

    def __init__(
        self,
        name: str,
        parameters: type[P],
        stop: Future,  # noqa: ARG002 - no message ends it
    ) -> None:
        """Read the parameters; `start` begins to listen.

        Raises:
            GhcError: a parameter cannot be used.
        """
        self.node = Node(name, automatically_declare_parameters_from_overrides=True)
        self.parameters: P = read_parameters(self.node, parameters)
        self.executor = self.parameters.executor
        self.clock = TickClock(round(self.parameters.settings.step * NANOSECONDS))
        self.rejections = Rejections()
        self._name = name
        self._early: list[Callable[[], None]] = []  # what came before the first tick
        self._next_run: deque[Callable[[], None]] = deque(maxlen=MOST_EARLY)
        self._in_force: list[bytes] = []  # the last two controller_states, until the first plan
        self._waiting_since: float | None = None  # [s] wall
        self._held_back_ns: int | None = None  # tick [ns] that waits for an input
        self._started = False  # a plan has been made
        self._tick_time = 0.0  # [s] wall, longest since the last diagnostics

    @abstractmethod
    def plan(self, start_ns: int) -> None:
        """Make the plan of a tick and publish it."""

    @abstractmethod
    def publish_again(self) -> None:
        """Publish the last plan once more."""

    @abstractmethod
    def reset(self) -> None:
        """Forget plans: time starts again."""

    @abstractmethod
    def take_over(self, states: Sequence[bytes], start_ns: int) -> bool:
        """Start from what the newest serialized ControllerStates, one or two, say is in force.

        The plan begins at `start_ns` [ns]. False when inputs are missing without which there
        would be nothing to plan for them.
        """

    @abstractmethod
    def report(self) -> tuple[Mapping[str, int], int]:
        """Counts, and how many of them are trouble."""

    def ready(self, start_ns: int) -> bool:  # noqa: ARG002 - for those who wait for an input
        """Whether all that the tick at `start_ns` [ns] waits for has come."""
        return True

    def start(self) -> None:
        """Listen to ticks, publish diagnostics."""
        self._diagnostics = self.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._controller: Subscription | None = self.listen(
            ControllerState, "ghc/controller_state", self._on_controller, STREAM_QOS, True
        )
        listen_to_epochs(self.node, self.clock.timeline, self.reject)
        self.listen(Tick, "ghc/tick", self._on_tick, CONTROL_SUBSCRIBER_QOS, True)
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=wall)

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

    def waits_for_next_run(self, stamp_ns: int, handle: Callable[[], None]) -> bool:
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
            self.publish_again()
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
        if not self.ready(start_ns) or self._waits_to_take_over(start_ns):
            return
        begun = time.perf_counter()
        self.plan(start_ns)
        self.clock.planned(stamp_ns)
        self._held_back_ns = None
        self._started = True
        self._in_force.clear()
        if self._controller is not None:  # it would wake this node at every account
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
        counts, trouble = self.report()
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

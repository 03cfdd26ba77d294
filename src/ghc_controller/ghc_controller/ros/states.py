"""Part of the controller node: receives states, pairs them with companions, rejects stale ones.

Publishes  ghc/tick (start and epoch of the generators' next tick).
Subscribes joint_states, contacts/<name> if steps wait for them, odom for a floating base,
           sim_bridge/epoch.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Protocol

from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import Tick
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import JointState

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.conversions.states import (
    base_from_bytes,
    read_joint_state,
    wrench_from_bytes,
)
from ghc_controller.ros.parameters import ControllerParameters
from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.run import tolerant
from ghc_controller.ros.wire.cdr import encode_tick, read_stamp
from ghc_controller.ros.wire.epochs import listen_to_epochs
from ghc_controller.ros.wire.joint_state import JointStateDecoder, JointStateValues
from ghc_controller.ros.wire.synchronizer import StateDisposition, StateGate
from ghc_controller.ros.wire.ticks import TickAnnouncer
from ghc_controller.ros.wire.timeline import MOST_AHEAD_NS, Timeline
from ghc_controller.types import NANOSECONDS, Array

STATES, ODOMETRY = "joint_states", "odom"
MOST_PERIODS = 20  # [-] control periods between two consecutive states, at most
_REFUSED = (StateDisposition.STALE, StateDisposition.IMPLAUSIBLE)


class Answers(Protocol):
    """Receiver of the states to be answered."""

    def answer(self, values: JointStateValues, new_epoch: bool) -> None:
        """Process a state; `new_epoch`: it is the first one of a run."""

    def repeat(self) -> None:
        """The last answered state was repeated: send the same command again."""

    def resume(self) -> None:
        """States were lost: the next one may be far from the last."""


class StateSubscriber:
    """Passes complete states of the current run to their receiver."""

    def __init__(
        self,
        node: Node,
        parameters: ControllerParameters,
        floating_base: bool,
        answers: Answers,
        reject: Callable[[str, str], object],
    ) -> None:
        """Subscribe; `reject` is called with the field and the reason of a rejection."""
        period_ns = round(parameters.settings.control_dt * NANOSECONDS)
        tick_ns = round(parameters.bounds_step * NANOSECONDS)
        contacts = parameters.wait_for_contacts
        self._answers = answers
        self._reject = reject
        self._gate: StateGate[JointStateValues] = StateGate(
            ((ODOMETRY,) if floating_base else ()) + contacts,
            parameters.wait_for_bounds,
            tick_ns,
            Timeline(max(MOST_AHEAD_NS, MOST_PERIODS * period_ns)),
        )
        self._announcer = TickAnnouncer(period_ns, tick_ns)
        self._decoder = JointStateDecoder(read_joint_state)
        self._ticks = node.create_publisher(Tick, "ghc/tick", CONTROL_PUBLISHER_QOS)
        listen_to_epochs(node, self._gate.timeline, reject)
        self._subscribe(node, JointState, STATES, self._on_state)
        for name in contacts:
            on_wrench = partial(self._on_companion, f"contacts/{name}", name, wrench_from_bytes)
            self._subscribe(node, WrenchStamped, f"contacts/{name}", on_wrench)
        if floating_base:
            on_base = partial(self._on_companion, ODOMETRY, ODOMETRY, base_from_bytes)
            self._subscribe(node, Odometry, ODOMETRY, on_base)

    def _subscribe(
        self, node: Node, kind: type, topic: str, callback: Callable[[bytes], None]
    ) -> None:
        take: Callable[[Any], None] = tolerant(callback, topic, self._reject)
        node.create_subscription(kind, topic, take, CONTROL_SUBSCRIBER_QOS, raw=True)

    @property
    def epoch(self) -> int:
        """Of the current run."""
        return self._gate.epoch

    def is_stale(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that has ended."""
        return self._gate.timeline.is_stale(stamp_ns)

    def is_of_next_run(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that was announced and has not begun."""
        return self._gate.timeline.is_of_next_run(stamp_ns)

    def companions(self, stamp_ns: int) -> tuple[Mapping[str, Array], Array | None]:
        """Wrenches by contact name, and the base, of the state of a stamp [ns]."""
        wrenches = self._gate.companions_of(stamp_ns)
        base = wrenches.pop(ODOMETRY, None)
        return wrenches, base

    def plan(self, name: str, stamp_ns: int, epoch: int) -> None:
        """A plan has arrived; process a state that waited for it."""
        self._continue(self._gate.plan(name, stamp_ns, epoch))

    def answered(self, stamp_ns: int) -> None:
        """The state of this stamp was answered."""
        self._gate.answered(stamp_ns)
        self._announce(self._announcer.on_answer(stamp_ns, self._gate.epoch))

    def forget(self) -> None:
        """Recompute the answer if the last state is repeated, since an input has changed."""
        self._gate.forget()

    def _on_state(self, data: bytes) -> None:
        try:
            state = self._decoder.decode(data)
        except ValueError as error:
            self._reject(STATES, str(error))
            return
        overdue_ns = self._gate.waiting_ns
        if overdue_ns is not None and state.stamp_ns > overdue_ns:
            for name in self._gate.missing(overdue_ns):
                self._reject(
                    f"{name}.stamp",
                    f"none of stamp {overdue_ns / NANOSECONDS:.6f} s came, as {STATES} has it",
                )
        disposition = self._gate.state(state, state.stamp_ns)
        if self._gate.timeline.resumed:
            self._answers.resume()
        if disposition not in _REFUSED:
            self._announce(self._announcer.on_state(state.stamp_ns, self._gate.epoch))
        self._handle(state, disposition)

    def _on_companion(
        self, topic: str, name: str, read: Callable[[bytes], Array], data: bytes
    ) -> None:
        try:
            value = read(data)
        except InvalidValue as error:
            self._reject(topic, str(error))
            return
        self._continue(self._gate.companion(name, read_stamp(data), value))

    def _continue(self, complete: tuple[JointStateValues, StateDisposition] | None) -> None:
        if complete is not None:
            self._handle(*complete)

    def _announce(self, tick_ns: int | None) -> None:
        if tick_ns is not None:
            self._ticks.publish(encode_tick(tick_ns, self._gate.epoch))

    def _handle(self, values: JointStateValues, disposition: StateDisposition) -> None:
        if disposition is StateDisposition.REPEATED:
            self._answers.repeat()
        elif disposition in (StateDisposition.NEW, StateDisposition.NEW_EPOCH):
            self._answers.answer(values, disposition is StateDisposition.NEW_EPOCH)
        elif disposition in _REFUSED:
            older = "older than the last one; " if disposition is StateDisposition.STALE else ""
            self._reject(
                f"{STATES}.stamp",
                f"{values.stamp_ns / NANOSECONDS:.6f} s given, "
                f"{older}{self._gate.timeline.expected()}",
            )

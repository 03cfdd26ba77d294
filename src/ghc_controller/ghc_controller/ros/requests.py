"""The part of the controller node that takes requests: other priorities, references.

Publishes  ghc/transition_status.
Subscribes ghc/priority_transition, ghc/task_reference.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from ghc_msgs.msg import PriorityTransition, TaskReference, TransitionStatus
from rclpy.node import Node

from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.hierarchy import TransitionEvent
from ghc_controller.ros.conversions.requests import (
    event_message,
    reference_from_message,
    status_message,
    transition_from_message,
)
from ghc_controller.ros.qos import RELIABLE_QOS
from ghc_controller.ros.run import tolerant


class RequestDesk:
    """Validates requests at the present state; those before the first state are queued."""

    def __init__(
        self,
        node: Node,
        controller: Controller,
        lockstep: bool,
        changed: Callable[[], None],
        reject: Callable[[str, str], None],
    ) -> None:
        """Hand requests to `controller`.

        Args:
            lockstep: refuse what should have started before now.
            changed: told that the state in force has to be worked out again.
            reject: told the field and the reason of a refusal.
        """
        self._controller = controller
        self._lockstep = lockstep
        self._changed = changed
        self._reject = reject
        self._early: list[Callable[[], None]] = []  # what came before the first state
        self._now: float | None = None  # [s] of the last state
        self._status = node.create_publisher(
            TransitionStatus, "ghc/transition_status", RELIABLE_QOS
        )
        for message, topic, handle in (
            (PriorityTransition, "ghc/priority_transition", self._on_transition),
            (TaskReference, "ghc/task_reference", self._on_reference),
        ):
            take = tolerant(partial(self._after_first_state, handle), topic, reject)
            node.create_subscription(message, topic, take, RELIABLE_QOS)

    @property
    def is_open(self) -> bool:
        """True from the first state on."""
        return self._now is not None

    def at(self, now: float) -> None:
        """Process queued requests at the state of time `now` [s]."""
        self._now = now
        for request in self._early:
            request()
        self._early.clear()

    def tell(self, events: Iterable[TransitionEvent]) -> None:
        """Publish what became of transitions."""
        for event in events:
            self._status.publish(event_message(event))

    def _after_first_state(
        self,
        handle: Callable[[PriorityTransition | TaskReference, float], None],
        message: PriorityTransition | TaskReference,
    ) -> None:
        if self._now is None:
            self._early.append(lambda: handle(message, self._now or 0.0))
        else:
            handle(message, self._now)

    def _on_transition(self, message: PriorityTransition, now: float) -> None:
        controller = self._controller
        try:
            transition = transition_from_message(message, controller.robot.task_names, now)
            self._check_start(transition.start, now)
            is_new = controller.add_transition(transition, now)
        except GhcError as error:
            self._status.publish(
                status_message(TransitionStatus.REJECTED, now, None, message.id, str(error))
            )
            self._reject("ghc/priority_transition", str(error))
            return
        if is_new:
            self._changed()
            self.tell(controller.take_events())
            return
        # A repeat: its DONE follows at once only where the ramp is over.
        self._status.publish(status_message(TransitionStatus.ACCEPTED, now, transition))
        if controller.priorities.is_settled:
            self._status.publish(status_message(TransitionStatus.DONE, now, transition))

    def _on_reference(self, message: TaskReference, now: float) -> None:
        controller = self._controller
        try:
            schedule = controller.schedule_of(message.task)
            task = schedule.task(message.task)
            current = schedule.current(message.task, now).position
            reference = reference_from_message(message, task, current, now)
            self._check_start(reference.start_time, now)
            controller.add_reference(reference)
        except GhcError as error:
            self._reject("ghc/task_reference", str(error))
            return
        self._changed()

    def _check_start(self, start: float, now: float) -> None:
        if self._lockstep and start < now:
            raise InvalidValue(
                f"start {start:g} s given, {now:g} s (now) or later expected: in lockstep a late "
                "request would make the run depend on when it arrived"
            )

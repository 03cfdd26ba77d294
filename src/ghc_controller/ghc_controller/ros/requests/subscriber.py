"""Part of the controller node: receives priority transitions and references, and applies them.

Publishes  ghc/transition_status, ghc/task_reference_status (replies.py).
Subscribes ghc/priority_transition, ghc/task_reference.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Protocol

from rclpy.node import Node

from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.hierarchy import Transition, TransitionEvent
from ghc_controller.references.progress import ReferenceProgress
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.ros.qos import RELIABLE_QOS
from ghc_controller.ros.requests.parser import RequestParser
from ghc_controller.ros.requests.queue import MOST_WAITING, Ready, RequestQueue
from ghc_controller.ros.requests.replies import Replies
from ghc_controller.ros.requests.topics import KINDS, most_bytes
from ghc_controller.ros.run import tolerant
from ghc_controller.ros.wire.cdr import STAMP_END, read_stamp
from ghc_controller.safety.modes import Mode, ModeLogic
from ghc_controller.types import NANOSECONDS


class States(Protocol):
    """Interface to the states at which requests are checked."""

    def forget(self) -> None:
        """The current state has to be recomputed."""

    def is_stale(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that has ended."""

    def is_of_next_run(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that was announced and has not begun."""


class RequestSubscriber:
    """Validates requests at the current state; those before the first state are queued."""

    def __init__(
        self,
        node: Node,
        controller: Controller,
        modes: ModeLogic,
        lockstep: bool,
        states: States,
        reject: Callable[[str, str], object],
    ) -> None:
        """Hand requests to `controller`.

        Args:
            modes: whether requests are accepted now; notified of every accepted one.
            lockstep: reject what should have started before now.
            states: which requests belong to a run that has ended; notified of changes.
            reject: called with the field and the reason of a rejection.
        """
        self._controller = controller
        self._modes = modes
        self._lockstep = lockstep
        self._states = states
        self._parser = RequestParser(controller)
        self._replies = Replies(node, reject)
        self._progress = ReferenceProgress()
        self._queue = RequestQueue(self._prepared, lockstep, reject)
        self._queue.start()
        for topic, kind in KINDS.items():
            take: Callable[[Any], None] = tolerant(partial(self._take, topic), topic, reject)
            node.create_subscription(kind, topic, take, RELIABLE_QOS, raw=True)

    def close(self) -> None:
        """End the thread that parses requests."""
        self._queue.close()

    @property
    def is_open(self) -> bool:
        """True from the first state on."""
        return self._queue.now is not None

    def at(self, now: float) -> None:
        """Apply the requests that are ready at the state of time `now` [s]."""
        self._queue.apply(now)
        if self._modes.mode is Mode.ACTIVE:
            self._replies.reference_events(self._progress.advance(now))
        else:
            self._replies.reference_events(self._progress.end_all(now, self._modes.reason))

    def begin_run(self) -> None:
        """A run has begun: apply requests that were sent ahead; references of earlier runs have
        ended."""
        self._replies.reference_events(
            self._progress.end_all(self._queue.now or 0.0, "another run has begun")
        )
        for topic, data in self._queue.take_kept():
            self._take(topic, data)

    def between_states(self) -> None:
        """Apply requests that are ready without a state, for example while time is paused."""
        if self._queue.now is not None:
            self.at(self._queue.now)

    def tell(self, events: Iterable[TransitionEvent]) -> None:
        """Publish the status of transitions."""
        self._replies.transition_events(events)

    def _take(self, topic: str, data: bytes) -> None:
        """Receive a serialized request."""
        most = most_bytes(topic, self._lockstep)
        if len(data) > most:
            self._refuse(topic, None, f"{len(data)} bytes given, at most {most} expected")
        elif len(data) >= STAMP_END and self._states.is_of_next_run(read_stamp(data)):
            self._queue.keep(topic, data)
        elif not self._queue.put(topic, data):
            self._refuse(topic, None, f"more than {MOST_WAITING} requests wait")

    def _prepared(self, topic: str, data: bytes) -> Ready:
        """How to apply a request at a state; in real time called in the thread of the queue."""
        message, now = None, self._queue.now
        try:
            message = self._parser.message(topic, data)
            if now is None or self._lockstep:
                # Checked when applied, since the check depends on the state.
                return partial(self._check_and_apply, topic, message)
            return partial(self._apply_checked, topic, message, self._checked(message, now), now)
        except Exception as error:  # a message may be anything
            return partial(self._refuse_at, topic, message, str(error))

    def _check_and_apply(self, topic: str, message: Any, now: float) -> None:
        try:
            value = self._checked(message, now)
        except Exception as error:  # as in `_prepared`
            self._refuse(topic, message, str(error))
            return
        self._apply(topic, message, value, now)

    def _apply_checked(
        self,
        topic: str,
        message: Any,
        value: Transition | ReferenceTrajectory,
        checked_at: float,
        now: float,
    ) -> None:
        if now < checked_at:  # the bridge was restarted meanwhile: its time is another one
            self._check_and_apply(topic, message, now)
        else:
            self._apply(topic, message, value, now)

    def _checked(self, message: Any, now: float) -> Transition | ReferenceTrajectory:
        """The request as a value; GhcError if it is invalid or is rejected in this mode."""
        self._check_mode()
        return self._parser.value(message, now)

    def _apply(
        self, topic: str, message: Any, value: Transition | ReferenceTrajectory, now: float
    ) -> None:
        try:
            is_new = self._add(value, now)
        except GhcError as error:
            self._refuse(topic, message, str(error))
            return
        except Exception as error:  # of another package: what was applied of it is not known
            self._refuse(topic, message, f"{type(error).__name__}: {error}")
            raise
        if isinstance(value, ReferenceTrajectory):
            self._replies.accepted_reference(message, value.start_time, now)
            self._progress.add(message.id, value)
        self._modes.requested()
        if is_new:
            self._states.forget()
        if not isinstance(value, Transition):
            return
        if is_new:
            self.tell(self._controller.take_events())
        else:
            self._replies.repeated(value, self._controller.priorities.is_settled, now)

    def _add(self, value: Transition | ReferenceTrajectory, now: float) -> bool:
        """Add to the controller; False for a transition that repeats the active target."""
        if isinstance(value, Transition):
            self._check_start(value.start, now)
            return self._controller.add_transition(value, now)
        self._check_start(value.start_time, now)
        self._controller.add_reference(value)
        return True

    def _refuse_at(self, topic: str, message: Any, reason: str, _: float) -> None:
        self._refuse(topic, message, reason)

    def _refuse(self, topic: str, message: Any, reason: str) -> None:
        self._replies.rejected(topic, message, reason, self._queue.now or 0.0)

    def _check_mode(self) -> None:
        refusal = self._modes.refusal()
        if refusal:
            raise InvalidValue(refusal)

    def _check_start(self, start: float, now: float) -> None:
        self._check_mode()
        if self._states.is_stale(round(start * NANOSECONDS)):
            raise InvalidValue(
                f"start {start:g} s given, which is of a run that has ended: the current one "
                "began after it (sim_bridge/epoch)"
            )
        if self._lockstep and start < now:
            raise InvalidValue(
                f"start {start:g} s given, {now:g} s (now) or later expected: in lockstep a late "
                "request would make the run depend on when it arrived"
            )

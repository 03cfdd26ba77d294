"""The part of the controller node that takes requests: other priorities, references.

Publishes  ghc/transition_status, ghc/task_reference_status.
Subscribes ghc/priority_transition, ghc/task_reference.

In real time a request is deserialized, parsed and checked by a thread of its own; the control
thread only takes over what is ready, a few at a state. In lockstep, where time stands still
meanwhile, all happens at once, so that a run does not depend on when a thread was scheduled.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from functools import partial
from queue import Empty, Full, Queue
from threading import Thread
from typing import Any, Protocol

from ghc_msgs.msg import (
    PriorityTransition,
    TaskReference,
    TaskReferenceStatus,
    TransitionStatus,
)
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from ghc_controller.controller import Controller
from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.hierarchy import Transition, TransitionEvent
from ghc_controller.references.plausibility import check_plausible
from ghc_controller.references.progress import ReferenceEvent, ReferenceProgress
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.ros.conversions.requests import (
    event_message,
    reference_event_message,
    reference_from_message,
    reference_status_message,
    status_message,
    transition_from_message,
)
from ghc_controller.ros.qos import RELIABLE_QOS
from ghc_controller.ros.run import tolerant
from ghc_controller.ros.wire.cdr import STAMP_END, read_stamp
from ghc_controller.safety.modes import Mode, ModeLogic
from ghc_controller.types import NANOSECONDS

TRANSITION, REFERENCE = "ghc/priority_transition", "ghc/task_reference"
# [bytes] of a serialized request: a reference of over a thousand points, a hierarchy of any robot.
MOST_BYTES = {TRANSITION: 1 << 16, REFERENCE: 1 << 18}
MOST_BYTES_LOCKSTEP = 1 << 26  # [bytes] time stands still meanwhile
MOST_WAITING = 4096  # [-] requests that wait for a state, or for the thread
MOST_NAME, MOST_WORDS = 200, 1000  # [-] characters of an id and of a reason in a reply
MOST_PER_STATE = 4  # [-] requests that are taken over at one state in real time

Ready = Callable[[float], None]  # takes a request over at a time [s]


class States(Protocol):
    """The states that requests are judged at."""

    def forget(self) -> None:
        """The state in force has to be worked out again."""

    def is_stale(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that has ended."""

    def is_of_next_run(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that was announced and has not begun."""


class RequestSubscriber:
    """Validates requests at the present state; those before the first state are queued."""

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
            modes: says whether requests are taken now; told of every accepted one.
            lockstep: refuse what should have started before now.
            states: say which requests are of a run that has ended; told of what changes.
            reject: told the field and the reason of a refusal.
        """
        self._controller = controller
        self._modes = modes
        self._lockstep = lockstep
        self._states = states
        self._reject = reject
        self._ready: deque[Ready] = deque()  # parsed, for the next state
        self._early: deque[tuple[str, bytes]] = deque(maxlen=MOST_WAITING)  # for the next run
        self._now: float | None = None  # [s] of the last state
        self._status = node.create_publisher(
            TransitionStatus, "ghc/transition_status", RELIABLE_QOS
        )
        self._reference_status = node.create_publisher(
            TaskReferenceStatus, "ghc/task_reference_status", RELIABLE_QOS
        )
        self._progress = ReferenceProgress()
        kinds = {TRANSITION: PriorityTransition, REFERENCE: TaskReference}
        self._kinds: dict[str, type] = kinds
        self._incoming: Queue[tuple[str, bytes]] = Queue(MOST_WAITING)
        if not lockstep:
            Thread(target=self._work, name="requests", daemon=True).start()
        for topic, kind in kinds.items():
            take = tolerant(partial(self._take, topic), topic, reject)
            node.create_subscription(kind, topic, take, RELIABLE_QOS, raw=True)

    @property
    def is_open(self) -> bool:
        """True from the first state on."""
        return self._now is not None

    def at(self, now: float) -> None:
        """Take over what is ready at the state of time `now` [s]."""
        self._now = now
        left = MOST_WAITING if self._lockstep else MOST_PER_STATE
        while self._ready and left:
            self._ready.popleft()(now)
            left -= 1
        if self._modes.mode is Mode.ACTIVE:
            self._end(self._progress.advance(now))
        else:
            self._end(self._progress.end_all(now, self._modes.reason))

    def begin_run(self) -> None:
        """A run has begun: what came for it before is taken, references of others have ended."""
        self._end(self._progress.end_all(self._now or 0.0, "another run has begun"))
        early = list(self._early)
        self._early.clear()
        for topic, data in early:
            self._take(topic, data)

    def between_states(self) -> None:
        """Take over what is ready although no state comes, as while time is paused."""
        if self._now is not None:
            self.at(self._now)

    def tell(self, events: Iterable[TransitionEvent]) -> None:
        """Publish what became of transitions."""
        for event in events:
            self._status.publish(event_message(event))

    def _take(self, topic: str, data: bytes) -> None:
        """A serialized request has come."""
        most = MOST_BYTES_LOCKSTEP if self._lockstep else MOST_BYTES[topic]
        if len(data) > most:
            self._refuse(topic, None, f"{len(data)} bytes given, at most {most} expected")
        elif len(data) >= STAMP_END and self._states.is_of_next_run(read_stamp(data)):
            self._early.append((topic, data))
        elif self._lockstep:
            self._put(self._prepared(topic, data))
        else:
            try:
                self._incoming.put_nowait((topic, data))
            except Full:
                self._refuse(topic, None, f"more than {MOST_WAITING} requests wait")

    def _put(self, ready: Ready) -> None:
        """In lockstep: at once, or for the first state."""
        if self._now is not None:
            ready(self._now)
        elif len(self._ready) >= MOST_WAITING:
            self._ready.popleft()
            self._reject("requests", f"more than {MOST_WAITING} wait: the oldest one is dropped")
            self._ready.append(ready)
        else:
            self._ready.append(ready)

    def _work(self) -> None:
        while True:
            topic, data = self._incoming.get()
            while len(self._ready) >= MOST_WAITING:
                try:
                    dropped, _ = self._incoming.get(timeout=0.01)  # no state comes
                    self._reject(dropped, f"more than {MOST_WAITING} requests wait: dropped")
                except Empty:
                    continue
            self._ready.append(self._prepared(topic, data))

    def _prepared(self, topic: str, data: bytes) -> Ready:
        """What is to be done with a request at a state; in real time in the thread."""
        message = None
        try:
            message = deserialize_message(data, self._kinds[topic])
            if self._now is None or self._lockstep:
                # Checked where it is taken over: it depends on the state there.
                return partial(self._convert_and_take, topic, message)
            return self._converted(message, self._now)
        except Exception as error:  # a message may be anything
            return partial(self._refuse_at, topic, message, str(error))

    def _convert_and_take(self, topic: str, message: Any, now: float) -> None:
        try:
            ready = self._converted(message, now)
        except GhcError as error:
            self._refuse(topic, message, str(error))
            return
        ready(now)

    def _converted(self, message: Any, now: float) -> Ready:
        """The request as a value; GhcError where it cannot be one."""
        controller = self._controller
        if isinstance(message, PriorityTransition):
            tasks = controller.robot.task_names
            transition = transition_from_message(message, tasks, now)
            return partial(self._take_transition, message, transition)
        schedule = controller.schedule_of(message.task)
        task = schedule.task(message.task)
        current = schedule.peek(message.task, now).position
        reference = reference_from_message(message, task, current, now)
        check_plausible(task, reference, controller.model.limits, controller.model.joint_names)
        return partial(self._take_reference, message, reference)

    def _take_transition(
        self, message: PriorityTransition, transition: Transition, now: float
    ) -> None:
        controller = self._controller
        try:
            self._check(transition.start, now)
            is_new = controller.add_transition(transition, now)
        except GhcError as error:
            self._refuse(TRANSITION, message, str(error))
            return
        self._modes.requested()
        if is_new:
            self._states.forget()
            self.tell(controller.take_events())
            return
        # A repeat: its DONE follows at once only where the ramp is over.
        self._status.publish(status_message(TransitionStatus.ACCEPTED, now, transition))
        if controller.priorities.is_settled:
            self._status.publish(status_message(TransitionStatus.DONE, now, transition))

    def _take_reference(
        self, message: TaskReference, reference: ReferenceTrajectory, now: float
    ) -> None:
        try:
            self._check(reference.start_time, now)
            self._controller.add_reference(reference)
        except GhcError as error:
            self._refuse(REFERENCE, message, str(error))
            return
        self._reference_status.publish(
            reference_status_message(
                TaskReferenceStatus.ACCEPTED, now, message, reference.start_time
            )
        )
        self._progress.add(message.id, reference)
        self._modes.requested()
        self._states.forget()

    def _end(self, events: Iterable[ReferenceEvent]) -> None:
        for event in events:
            self._reference_status.publish(reference_event_message(event))

    def _refuse_at(self, topic: str, message: Any, reason: str, _: float) -> None:
        self._refuse(topic, message, reason)

    def _refuse(self, topic: str, message: Any, reason: str) -> None:
        """Reply to a request that cannot be taken; `message` is None where it cannot be read."""
        reason, now = reason[:MOST_WORDS], self._now or 0.0
        name = "" if message is None else message.id[:MOST_NAME]
        if topic == TRANSITION:
            status = TransitionStatus.REJECTED
            self._status.publish(status_message(status, now, None, name, reason))
        else:
            task = "" if message is None else message.task[:MOST_NAME]
            status = TaskReferenceStatus.REJECTED
            request = TaskReference(id=name, task=task)
            self._reference_status.publish(
                reference_status_message(status, now, request, reason=reason)
            )
        self._reject(topic, reason)

    def _check(self, start: float, now: float) -> None:
        refusal = self._modes.refusal()
        if refusal:
            raise InvalidValue(refusal)
        if self._states.is_stale(round(start * NANOSECONDS)):
            raise InvalidValue(
                f"start {start:g} s given, which is of a run that has ended: the one under way "
                "began after it (sim_bridge/epoch)"
            )
        if self._lockstep and start < now:
            raise InvalidValue(
                f"start {start:g} s given, {now:g} s (now) or later expected: in lockstep a late "
                "request would make the run depend on when it arrived"
            )

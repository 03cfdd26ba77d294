"""The priority matrix over time: scheduled, running and finished transitions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.priority_matrix import PriorityMatrix
from ghc_controller.hierarchy.ramp import PacedPriorities, Ramp
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.hierarchy.transition import Transition
from ghc_controller.types import Array


class TransitionPhase(Enum):
    """What happens to a transition; the names of ghc_msgs/TransitionStatus."""

    ACCEPTED = "ACCEPTED"
    ACTIVE = "ACTIVE"
    DONE = "DONE"
    PREEMPTED = "PREEMPTED"


@dataclass(frozen=True, slots=True)
class TransitionEvent:
    """One change of phase of one transition."""

    transition: Transition
    phase: TransitionPhase
    time: float  # [s]


class TransitionSchedule:
    """Holds the matrix in force; the newest transition replaces the whole target.

    `smallest_singular_value(alpha)` is that of [P_1 .. P_k] at the present configuration, which
    is reported. `solvability()` says what is refused there; left out, it looks at that value.
    """

    tasks: tuple[str, ...]
    target: PriorityMatrix  # of the last transition that started
    in_force: Priorities  # at the time of the last `advance`
    sigma_min: float

    def __init__(
        self,
        initial: PriorityMatrix,
        smallest_singular_value: Callable[[Array], float],
        solvability: Callable[[], Solvability] | None = None,
    ) -> None:
        self._initial = initial
        self._sigma = smallest_singular_value
        self._solvability = solvability or (lambda: Solvability(smallest_singular_value))
        self.reset()

    def reset(self) -> None:
        """Back to the initial matrix, with no transition left."""
        self.tasks = self._initial.tasks
        self.target = self._initial
        self.in_force = Priorities.of(self._initial.alpha)
        self.sigma_min = float("nan")
        self._ramp = Ramp(self.in_force.candidates, self._initial.alpha)
        self._progress = 1.0
        self._now = float("-inf")  # [s] of the last `advance`
        self._begin = 1.0  # progress at the begin of the step at that time
        self._running: Transition | None = None
        self._pending: list[Transition] = []

    @property
    def alpha(self) -> Array:
        """(k, k) matrix in force."""
        return self.in_force.alpha

    @property
    def in_transition(self) -> bool:
        """True while a ramp is running."""
        return self._running is not None

    @property
    def running(self) -> Transition | None:
        """The ramp under way."""
        return self._running

    @property
    def pending(self) -> tuple[Transition, ...]:
        """Accepted transitions that have not started, earliest first."""
        return tuple(self._pending)

    def is_repeat(self, transition: Transition) -> bool:
        """True for a request that changes nothing.

        Such is the last scheduled one given again, the ramp under way, or the target in force.
        Another duration, profile or torque rate is a change.
        """
        if self._pending:
            last = self._pending[-1]
            return transition.start == last.start and _is_same_ramp(transition, last)
        if self._running is not None:
            return _is_same_ramp(transition, self._running)
        return np.array_equal(transition.target.alpha, self.target.alpha)

    @property
    def is_settled(self) -> bool:
        """True when the target is in force and nothing is scheduled."""
        return self._running is None and not self._pending

    def check_solvable(self, transition: Transition) -> float:
        """Least solvability from the matrix before this transition to its target.

        Raises:
            InvalidValue: it falls below what is expected.
        """
        before = [t for t in self._pending if t.start <= transition.start]
        start = before[-1].target.alpha if before else self.alpha
        return self._solvability().check(start, transition.target.alpha, self.tasks)

    def add(self, transition: Transition, now: float) -> list[TransitionEvent]:
        """Accept a checked transition; one due now starts at the next `advance`.

        One that should have started before the time of the last `advance` starts there instead:
        what was in force until then stays so, and alpha does not jump into the middle of a ramp.
        """
        if transition.start < self._now:
            transition = replace(transition, start=self._now)
        self.sigma_min = self._sigma(transition.target.alpha)
        self._pending.append(transition)
        self._pending.sort(key=lambda t: t.start)  # stable: of equal starts the newest wins
        return [TransitionEvent(transition, TransitionPhase.ACCEPTED, now)]

    def cancel(self, now: float) -> list[TransitionEvent]:
        """Back to the initial matrix at `now` [s]; what runs or waits is pre-empted."""
        left = [self._running] if self._running is not None else []
        left += self._pending
        self.reset()
        self._now = now  # a request from before it must not start before it
        return [TransitionEvent(entry, TransitionPhase.PREEMPTED, now) for entry in left]

    def advance(self, now: float) -> list[TransitionEvent]:
        """Bring `in_force` to time `now`; returns what happened on the way, in order.

        A ramp with a torque-rate budget goes on once per time: again at the same time it goes
        from where it stood there.
        """
        events: list[TransitionEvent] = []
        if now != self._now:
            self._now, self._begin = now, self._progress
        elif self._running is not None and self._running.torque_rate > 0.0:
            self._progress = self._begin
        while self._pending and self._pending[0].start <= now:
            transition = self._pending.pop(0)
            self._move_to(transition.start, events)
            if self._running is not None:
                events.append(
                    TransitionEvent(self._running, TransitionPhase.PREEMPTED, transition.start)
                )
            self._ramp = Ramp(self._ramp.at(self._progress), transition.target.alpha)
            self._progress = self._begin = 0.0
            self._running = transition
            self.target = transition.target
            events.append(TransitionEvent(transition, TransitionPhase.ACTIVE, transition.start))
        self._move_to(now, events)
        return events

    def pace(self, now: float, period: float) -> Priorities:
        """Priorities of the step at `now`: `in_force`, or a ramp to be paced by its budget.

        Args:
            period: [s] between two steps, to turn the budget into a change of torque.
        """
        running = self._running
        if running is None or running.torque_rate == 0.0:
            return self.in_force
        step = running.torque_rate * period
        return PacedPriorities.on(self._ramp, self._progress, running.progress(now), step)

    def settle(self, progress: float, now: float) -> list[TransitionEvent]:
        """Take over how far a ramp with a budget went in the step at `now`."""
        running = self._running
        if running is None or running.torque_rate == 0.0:
            return []
        self._progress = max(self._progress, progress)
        self.in_force = Priorities.mixed(self._ramp.at(self._progress))
        if self._progress < 1.0:
            return []
        self._running = None
        return [TransitionEvent(running, TransitionPhase.DONE, now)]

    def _move_to(self, time: float, events: list[TransitionEvent]) -> None:
        running = self._running
        if running is None:
            return
        if running.torque_rate > 0.0:  # `settle` moves it, by the answers of each step
            self.in_force = Priorities.mixed(self._ramp.at(self._progress))
            return
        ends = time >= running.end
        self._progress = 1.0 if ends else running.progress(time)
        self.in_force = Priorities.mixed(self._ramp.at(self._progress))
        if ends:
            self._running = None
            events.append(TransitionEvent(running, TransitionPhase.DONE, running.end))


def _is_same_ramp(one: Transition, other: Transition) -> bool:
    """Whether both ask for the same ramp, whenever it starts."""
    return (one.id, one.duration, one.profile, one.torque_rate) == (
        other.id,
        other.duration,
        other.profile,
        other.torque_rate,
    ) and np.array_equal(one.target.alpha, other.target.alpha)

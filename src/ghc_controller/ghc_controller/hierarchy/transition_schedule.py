"""The priority matrix over time: scheduled, running and finished transitions."""

from __future__ import annotations

from bisect import bisect_right, insort_right
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from operator import attrgetter

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.priority_matrix import PriorityMatrix
from ghc_controller.hierarchy.ramp import PacedPriorities, Ramp
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.hierarchy.transition import Transition
from ghc_controller.types import Array

MOST_PENDING = 256  # [-] transitions whose start is still to come
_START = attrgetter("start")


class TransitionPhase(Enum):
    """Phases of a transition; the names of ghc_msgs/TransitionStatus."""

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
    """Holds the current matrix; the newest transition replaces the whole target.

    `smallest_singular_value(alpha)` is that of [P_1 .. P_k] at the current configuration; it is
    reported. `solvability()` defines which targets are rejected; by default it uses that value.
    """

    tasks: tuple[str, ...]
    target: PriorityMatrix  # of the last transition that started
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
        """Reset to the initial matrix and discard all transitions."""
        self.tasks = self._initial.tasks
        self.target = self._initial
        initial = Priorities.of(self._initial.alpha)
        self.sigma_min = float("nan")
        self._ramp = Ramp(initial.candidates, self._initial.alpha)
        self._progress = 1.0
        self._in_force: Priorities | None = initial  # None: to be made of the ramp
        self._mixture: tuple[tuple[Array, ...], tuple[float, ...]] | None = None  # alike
        self._now = float("-inf")  # [s] of the last `advance`
        self._begin = 1.0  # progress at the beginning of the step at that time
        self._running: Transition | None = None
        self._pending: list[Transition] = []

    @property
    def in_force(self) -> Priorities:
        """Priorities at the time of the last `advance`."""
        if self._in_force is None:
            self._in_force = Priorities.mixed(self._ramp.at(self._progress))
        return self._in_force

    @property
    def mixture(self) -> tuple[tuple[Array, ...], tuple[float, ...]]:
        """Their matrices and shares; the same matrices come back as the same tuple."""
        if self._mixture is None:
            self._mixture = self._ramp.mixture(self._progress)
        return self._mixture

    @property
    def alpha(self) -> Array:
        """(k, k) current matrix."""
        return self.in_force.alpha

    @property
    def in_transition(self) -> bool:
        """True while a ramp is running."""
        return self._running is not None

    @property
    def running(self) -> Transition | None:
        """The running ramp."""
        return self._running

    def is_paced_at(self, time: float) -> bool:
        """True while a ramp with a torque-rate budget is running, or starts by `time` [s]."""
        if self._running is not None and self._running.torque_rate > 0.0:
            return True
        return bool(self._pending) and any(
            one.start <= time and one.torque_rate > 0.0 for one in self._pending
        )

    @property
    def pending(self) -> tuple[Transition, ...]:
        """Accepted transitions that have not started, earliest first."""
        return tuple(self._pending)

    def is_repeat(self, transition: Transition) -> bool:
        """True for a request that changes nothing.

        True if it repeats the last scheduled request, the running ramp, or the current target. A
        different duration, profile or torque rate is a change.
        """
        if self._pending:
            last = self._pending[-1]
            return transition.start == last.start and _is_same_ramp(transition, last)
        if self._running is not None:
            return _is_same_ramp(transition, self._running)
        return np.array_equal(transition.target.alpha, self.target.alpha)

    @property
    def is_settled(self) -> bool:
        """True when the target is active and nothing is scheduled."""
        return self._running is None and not self._pending

    def check_solvable(self, transition: Transition) -> float:
        """Smallest solvability from the matrix before this transition to its target.

        Raises:
            InvalidValue: it is below the required value.
        """
        before = bisect_right(self._pending, transition.start, key=_START)
        start = self._pending[before - 1].target.alpha if before else self.alpha
        return self._solvability().check(start, transition.target.alpha, self.tasks)

    def add(self, transition: Transition, now: float) -> list[TransitionEvent]:
        """Accept a checked transition; one due now starts at the next `advance`.

        A start before the last `advance` is moved to that time, so that alpha does not jump into
        the middle of a ramp.

        Raises:
            InvalidValue: MOST_PENDING transitions wait already.
        """
        if len(self._pending) >= MOST_PENDING:
            raise InvalidValue(
                f"start {transition.start:g} s given; {len(self._pending)} transitions wait for "
                f"theirs, less than {MOST_PENDING} expected"
            )
        if transition.start < self._now:
            transition = replace(transition, start=self._now)
        self.sigma_min = self._sigma(transition.target.alpha)
        insort_right(self._pending, transition, key=_START)  # of equal starts the newest wins
        return [TransitionEvent(transition, TransitionPhase.ACCEPTED, now)]

    def cancel(self, now: float) -> list[TransitionEvent]:
        """Return to the initial matrix at `now` [s]; preempts running and pending transitions."""
        left = [self._running] if self._running is not None else []
        left += self._pending
        self.reset()
        self._now = now  # earlier requests must not start before this time
        return [TransitionEvent(entry, TransitionPhase.PREEMPTED, now) for entry in left]

    def hold(self, priorities: Priorities, now: float) -> list[TransitionEvent]:
        """Put priorities in force without a ramp; preempts running and pending transitions.

        For priorities that are computed anew at each step, such as from a distance. They stay
        until the next call or until a transition starts, which begins at them.
        """
        events = self.cancel(now)
        self.target = PriorityMatrix(self.tasks, np.clip(priorities.alpha, 0.0, 1.0))
        candidates = priorities.candidates
        self._ramp = Ramp(candidates, candidates[-1].alpha)
        self._move(0.0)  # where the shares of the ramp are those given
        return events

    def advance(self, now: float) -> list[TransitionEvent]:
        """Advance `in_force` to time `now`; returns the events since the last call, in order.

        A ramp with a torque-rate budget advances once per time: repeated at the same time, it
        starts from the same progress.
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

    def glide(self, now: float) -> tuple[tuple[Array, ...], tuple[float, ...]] | None:
        """`advance` and `mixture` in one where no transition begins, ends or is paced.

        Returns:
            None where `advance` has to look; nothing was moved then.
        """
        running = self._running
        if self._pending:
            return None
        if running is not None and (running.torque_rate > 0.0 or now >= running.end):
            return None
        if now != self._now:
            self._now, self._begin = now, self._progress
        if running is not None:
            self._progress, self._in_force = running.progress(now), None
            self._mixture = self._ramp.mixture(self._progress)
        elif self._mixture is None:
            self._mixture = self._ramp.mixture(self._progress)
        return self._mixture

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
        """Store the progress of a ramp with a budget after the step at `now`."""
        running = self._running
        if running is None or running.torque_rate == 0.0:
            return []
        self._move(max(self._progress, progress))
        if self._progress < 1.0:
            return []
        self._running = None
        return [TransitionEvent(running, TransitionPhase.DONE, now)]

    def _move(self, progress: float) -> None:
        self._progress, self._in_force, self._mixture = progress, None, None

    def _move_to(self, time: float, events: list[TransitionEvent]) -> None:
        running = self._running
        if running is None:
            return
        if running.torque_rate > 0.0:  # advanced by `settle`, from the solutions of each step
            self._move(self._progress)
            return
        ends = time >= running.end
        self._move(1.0 if ends else running.progress(time))
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

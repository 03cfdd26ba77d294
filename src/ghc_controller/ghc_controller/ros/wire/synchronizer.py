"""Which robot states are answered: new ones once, repeated ones with the same command, stale
ones never."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Generic, TypeVar

from ghc_controller.ros.wire.timeline import Place, Timeline
from ghc_controller.types import Array

M = TypeVar("M")
KEPT = 8  # [-] companions kept per name: one with a wrong stamp must not replace the right one


class StateDisposition(Enum):
    """Classification of a state message."""

    NEW = "new"  # to be answered
    NEW_EPOCH = "new epoch"  # to be answered after a reset of the history
    REPEATED = "repeated"  # answered before: the same command again
    STALE = "stale"  # older than the last answered one
    WAITING = "waiting"  # a companion is still missing
    IMPLAUSIBLE = "implausible"  # far from the current run, see Timeline


class StateGate(Generic[M]):
    """Pairs states with their companions and distinguishes new from repeated ones.

    The stamp is the sequence number of a state; a `Timeline` decides which stamps are accepted. A
    state is complete with its companions (wrenches, odometry) of the same stamp and the plans of
    the last generator tick at or before it.
    """

    def __init__(
        self,
        companions: Sequence[str],
        plans: Sequence[str] = (),
        tick_ns: int = 1,
        timeline: Timeline | None = None,
    ) -> None:
        """Names of companions and plans to wait for; `tick_ns` [ns] between two plans."""
        self.timeline = timeline or Timeline()
        self._companions: dict[str, dict[int, Array]] = {name: {} for name in companions}
        self._plans = dict.fromkeys(plans, (-1, -1))  # epoch, stamp [ns]
        self._tick_ns = tick_ns
        self._waiting: tuple[M, int] | None = None
        self._answered_ns = -1
        self._repeatable = False
        self._begins = False  # a run has begun, and no state of it was answered yet

    @property
    def epoch(self) -> int:
        """Number of the current run."""
        return self.timeline.epoch

    def companions_of(self, stamp_ns: int) -> dict[str, Array]:
        """Received companions of the state of this stamp, by name."""
        found = self._companions.items()
        return {name: kept[stamp_ns] for name, kept in found if stamp_ns in kept}

    def missing(self, stamp_ns: int) -> tuple[str, ...]:
        """Names of the missing companions of the state of this stamp."""
        tick = (self.epoch, stamp_ns - stamp_ns % self._tick_ns)
        missing = [name for name, kept in self._companions.items() if stamp_ns not in kept]
        return tuple(missing + [name for name, plan in self._plans.items() if plan < tick])

    @property
    def waiting_ns(self) -> int | None:
        """Stamp [ns] of the waiting state, if any."""
        return None if self._waiting is None else self._waiting[1]

    def state(self, message: M, stamp_ns: int) -> StateDisposition:
        """Classify a state message by its stamp."""
        place = self.timeline.judge(stamp_ns)
        if place is Place.OLDER:
            return StateDisposition.STALE
        if place is Place.ELSEWHERE:
            return StateDisposition.IMPLAUSIBLE
        if place is Place.RESTARTED:
            self._repeatable, self._begins = False, True
            self._plans = dict.fromkeys(self._plans, (-1, -1))
        if stamp_ns == self._answered_ns and self._repeatable:
            return StateDisposition.REPEATED
        if self.missing(stamp_ns):
            self._waiting = (message, stamp_ns)
            return StateDisposition.WAITING
        self._waiting = None
        return self._news

    def companion(
        self, name: str, stamp_ns: int, value: Array
    ) -> tuple[M, StateDisposition] | None:
        """Add a companion; returns the state message that it completes, if any."""
        kept = self._companions[name]
        kept[stamp_ns] = value
        if len(kept) > KEPT:
            del kept[next(iter(kept))]  # the oldest one
        return self._completed()

    def plan(self, name: str, stamp_ns: int, epoch: int) -> tuple[M, StateDisposition] | None:
        """Register a plan; returns the state message that it completes, if any."""
        if name not in self._plans:
            return None
        self._plans[name] = (epoch, stamp_ns)
        return self._completed()

    def answered(self, stamp_ns: int) -> None:
        """Register that a command for this state was published."""
        self._answered_ns = stamp_ns
        self._repeatable, self._begins = True, False

    def forget(self) -> None:
        """Recompute the last state if it is repeated, since an input has changed."""
        self._repeatable = False

    def _completed(self) -> tuple[M, StateDisposition] | None:
        if self._waiting is None or self.missing(self._waiting[1]):
            return None
        message, _ = self._waiting
        self._waiting = None
        return message, self._news

    @property
    def _news(self) -> StateDisposition:
        """Disposition of a new state; the first answered one begins a run."""
        return StateDisposition.NEW_EPOCH if self._begins else StateDisposition.NEW

"""Which robot states are answered: new ones once, repeated ones alike, old ones not at all."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Generic, TypeVar

from ghc_controller.ros.wire.timeline import Place, Timeline
from ghc_controller.types import Array

M = TypeVar("M")


class StateDisposition(Enum):
    """What a state message is."""

    NEW = "new"  # to be answered
    NEW_EPOCH = "new epoch"  # to be answered after forgetting the past
    REPEATED = "repeated"  # answered before: the same command again
    STALE = "stale"  # older than the last answered one
    WAITING = "waiting"  # something that belongs to it is still to come
    IMPLAUSIBLE = "implausible"  # far from the run under way, see Timeline


class StateGate(Generic[M]):
    """Pairs states with what belongs to them and tells repeats from news.

    The stamp is the sequence number of a state; a `Timeline` says which stamps are believed. To a
    state belong its companions (wrenches, odometry), which carry the same stamp, and plans that a
    generator makes for the latest of its ticks at or before it.
    """

    def __init__(
        self,
        companions: Sequence[str],
        plans: Sequence[str] = (),
        tick_ns: int = 1,
        timeline: Timeline | None = None,
    ) -> None:
        """Wait for these, by name; `tick_ns` [ns] between two plans."""
        self.timeline = timeline or Timeline()
        self._stamps = dict.fromkeys(companions, -1)
        self._values: dict[str, Array] = {}
        self._plans = dict.fromkeys(plans, (-1, -1))  # epoch, stamp [ns]
        self._tick_ns = tick_ns
        self._waiting: tuple[M, int] | None = None
        self._answered_ns = -1
        self._repeatable = False
        self._begins = False  # a run has begun, and none of its states was answered yet

    @property
    def epoch(self) -> int:
        """Number of the run under way."""
        return self.timeline.epoch

    @property
    def values(self) -> dict[str, Array]:
        """Companions of the state under way by name."""
        return dict(self._values)

    def missing(self, stamp_ns: int) -> tuple[str, ...]:
        """Names of what the state of this stamp still waits for."""
        tick = (self.epoch, stamp_ns - stamp_ns % self._tick_ns)
        missing = [name for name, stamp in self._stamps.items() if stamp != stamp_ns]
        return tuple(missing + [name for name, plan in self._plans.items() if plan < tick])

    @property
    def waiting_ns(self) -> int | None:
        """Stamp [ns] of the state that waits, if any."""
        return None if self._waiting is None else self._waiting[1]

    def state(self, message: M, stamp_ns: int) -> StateDisposition:
        """Judge a state message by its stamp."""
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
        """Take a companion; returns the state message that it completes, if any."""
        self._stamps[name] = stamp_ns
        self._values[name] = value
        return self._completed()

    def plan(self, name: str, stamp_ns: int, epoch: int) -> tuple[M, StateDisposition] | None:
        """Take note of a plan; returns the state message that it completes, if any."""
        if name not in self._plans:
            return None
        self._plans[name] = (epoch, stamp_ns)
        return self._completed()

    def answered(self, stamp_ns: int) -> None:
        """A command for this state was published."""
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
        """Of a state that was not answered before; a run begins with the first one that is."""
        return StateDisposition.NEW_EPOCH if self._begins else StateDisposition.NEW

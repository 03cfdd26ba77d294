"""Determines when a generator plans: at multiples of its step."""

from __future__ import annotations

import time
from collections.abc import Callable
from enum import Enum

from ghc_controller.ros.wire.timeline import MOST_AHEAD_NS, Place, Timeline

_MOST_TICKS = 20  # [-] largest number of ticks between two consecutive announcements


class Due(Enum):
    """Required action of a generator for a stamp."""

    PLAN = "plan"  # a new tick
    REPEAT = "repeat"  # the last tick again: same plan
    NOTHING = "nothing"  # between two ticks
    STALE = "stale"  # older than the last tick, in the same epoch
    IMPLAUSIBLE = "implausible"  # far from the current run, see Timeline


class TickClock:
    """Detects ticks among stamps; a `Timeline` decides which stamps are accepted.

    A missed tick is planned at the next stamp: its plan starts at the multiple of
    the step at or before it, so that plans do not depend on which stamp was received.
    """

    def __init__(self, step_ns: int, clock: Callable[[], float] = time.monotonic) -> None:
        """`step_ns` [ns] between ticks; `clock` gives wall time [s]."""
        self.timeline = Timeline(max(MOST_AHEAD_NS, _MOST_TICKS * step_ns), clock)
        self._step_ns = step_ns
        self._last_ns = -1
        self._repeatable = False
        self._seen_ns = -1
        self.new_epoch = False

    @property
    def epoch(self) -> int:
        """Number of the current run."""
        return self.timeline.epoch

    @property
    def tick_ns(self) -> int:
        """Start of the last tick [ns]; -1 before the first one."""
        return self._last_ns

    @property
    def now_ns(self) -> int:
        """The newest stamp seen [ns]; -1 before the first one."""
        return self._seen_ns

    def judge(self, stamp_ns: int, epoch: int) -> Due:
        """Action due at a stamp; afterwards `new_epoch` is True if the stamp starts a new run."""
        self.new_epoch = False
        tick_ns = stamp_ns - stamp_ns % self._step_ns
        place = self.timeline.judge(tick_ns, epoch)
        if place is Place.OLDER:
            return Due.STALE
        if place is Place.ELSEWHERE:
            return Due.IMPLAUSIBLE
        if place is Place.RESTARTED:
            self.new_epoch = True
        if place in (Place.RESTARTED, Place.RESUMED):
            self._last_ns = self._seen_ns = -1
            self._repeatable = False
        self._seen_ns = max(self._seen_ns, stamp_ns)
        if tick_ns > self._last_ns:
            return Due.PLAN
        if stamp_ns != tick_ns:
            return Due.NOTHING
        return Due.REPEAT if self._repeatable else Due.PLAN

    def planned(self, stamp_ns: int) -> int:
        """Register the plan of this stamp as published; returns the start of its tick [ns]."""
        self._last_ns = stamp_ns - stamp_ns % self._step_ns
        self._repeatable = True
        return self._last_ns

    def start_of(self, stamp_ns: int) -> int:
        """Start of the tick of a stamp [ns]."""
        return stamp_ns - stamp_ns % self._step_ns

    def forget(self) -> None:
        """Plan the last tick again if it is repeated, since an input has changed."""
        self._repeatable = False

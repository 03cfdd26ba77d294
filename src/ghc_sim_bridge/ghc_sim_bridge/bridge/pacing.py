"""How many control periods the wall clock asks for in realtime mode."""

from __future__ import annotations

MAX_CATCH_UP = 5  # [-] periods done at once after a delay; the rest is dropped: time slips


class Pacer:
    """Keeps simulated time on the wall clock without bursts after a long delay."""

    def __init__(self, period: float, now: float) -> None:
        """Periods of `period` [s] counted from `now` [s]."""
        self._period = period
        self._next = now + period
        self.overruns = 0  # [-] periods dropped since the start

    def restart(self, now: float) -> None:
        """Count from `now` [s]: after a pause or a reset."""
        self._next = now + self._period

    def due(self, now: float) -> int:
        """Periods to simulate at `now` [s], at most MAX_CATCH_UP."""
        if now < self._next:
            return 0
        late = int((now - self._next) / self._period) + 1
        self._next += late * self._period
        self.overruns += max(0, late - MAX_CATCH_UP)
        return min(late, MAX_CATCH_UP)

"""When the samples of a periodic sender were taken, from the times of their arrival."""

from __future__ import annotations

from itertools import pairwise
from statistics import median

_LEAST = 0.08  # [-] smallest gain: how fast a changed period or delay is followed
_FIRST = 8  # arrivals before a period is known
_APART = 1e-6  # [s] between two stamps at least
_LOST = 5.0  # [-] periods without a sample, or of error, after which it starts anew
_CLEAR = 3.0  # [-] times the jitter: in a longer period lost samples can be counted
_EARLY = 0.25  # [-] of a period that a sample after lost ones may come early


class ArrivalClock:
    """Least squares through arrival times with fading memory: a phase and a period.

    Jitter of arrivals becomes noise in space at the speed of the target. A sender with a period
    need not suffer from it: gains 2 (2 k - 1) / k (k + 1) and 6 / k (k + 1) after k samples are
    those of a line through all of them; they are kept above a floor.
    """

    def __init__(self, jitter: float) -> None:
        """For arrivals with a standard deviation of `jitter` [s]."""
        self._jitter = jitter
        self._first: list[float] = []  # arrivals until the period is known
        self._count = 0
        self._phase = self._last = -1.0  # [s] of the line, of the last stamp
        self._period = 0.0

    @property
    def has_line(self) -> bool:
        """Whether stamps come from the line: not at first, and not where it cannot be drawn."""
        return bool(self._count) and self._period > _CLEAR * self._jitter

    def stamp(self, arrival: float) -> float:
        """[s] for a sample that arrived at `arrival` [s]; grows from one to the next."""
        gap = arrival - self._phase
        if self._count and abs(gap) > _LOST * self._period:
            self._count = 0
            self._first.clear()
        if not self._count:
            self._begin(arrival)
        elif self._period > _CLEAR * self._jitter:
            self._follow(gap)
        else:  # lost samples and late ones look alike
            self._phase = arrival
        self._last = max(self._phase, self._last + _APART)
        return self._last

    def _follow(self, gap: float) -> None:
        self._count += 1
        k, share = self._count, gap / self._period
        steps = int(share + _EARLY) if share > 1.0 else round(share)
        error = gap - steps * self._period
        floor = _LEAST**2 / (2.0 - _LEAST)
        self._phase += gap - (1.0 - max(2.0 * (2.0 * k - 1.0) / (k * (k + 1.0)), _LEAST)) * error
        self._period += max(6.0 / (k * (k + 1.0)), floor) * error / max(steps, 1)

    def _begin(self, arrival: float) -> None:
        """The period is the median of the first gaps."""
        self._phase = arrival
        self._first.append(arrival)
        if len(self._first) == _FIRST:
            gaps = [b - a for a, b in pairwise(self._first)]
            self._period = max(median(gaps), _APART)
            self._count = _FIRST

"""When the samples of a periodic sender were taken, from the times of their arrival."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from statistics import fmean, linear_regression, median

_LEAST = 0.08  # [-] smallest gain: how fast a changed period or delay is followed
_FIRST = 8  # arrivals before a period is known
_APART = 1e-6  # [s] between two stamps at least
_LOST = 5.0  # [-] periods without a sample, after which it starts anew
_LATE = 3.0  # [-] times the jitter: a first arrival that is later than this follows lost ones
_SURE = 3.0  # [-] logarithm of the likelihood ratio at which samples count as lost
_ON_LINE = 0.5  # [-] times the jitter of arrivals: errors of stamps on the line, ...
_UNSURE = 8.0  # ... and where samples may be lost
_SETTLED = 3  # samples after the line was moved by periods, until it is trusted again, ...
_CLEAR = 3.0  # ... unless a period is longer than this many times the jitter
_LEAST_JITTER = 1e-3  # [s] taken for a smaller one


class ArrivalClock:
    """Least squares through arrival times with fading memory: a phase and a period.

    Jitter of arrivals becomes noise in space at the speed of the target. For a periodic sender
    this can be avoided: gains 2 (2 k - 1) / k (k + 1) and 6 / k (k + 1) after k samples are
    those of a line through all of them; they are kept above a floor.

    A late sample and a lost one look alike at first, since both arrive about a period after the
    line. Each sample is therefore the next one of the line until those after it tell: sums of
    log-likelihood ratios (Page 1954) of "by a period too late" and "too early" decide.
    """

    def __init__(self, jitter: float) -> None:
        """For arrivals with a standard deviation of `jitter` [s]."""
        self._jitter = max(jitter, _LEAST_JITTER)
        self._first: list[float] = []  # arrivals until the period is known
        self._count = 0
        self._phase = self._last = -1.0  # [s] of the line, of the last stamp
        self._period = 0.0
        self._forget_errors()

    @property
    def doubt(self) -> float:
        """[-] times the jitter that the error of the last stamp may have.

        Large at first, and where a sample may be missing or was just found to be.
        """
        sure = self._count and not (self._behind or self._ahead)
        settled = self._since >= _SETTLED or self._period > _CLEAR * self._jitter
        return _ON_LINE if sure and settled else _UNSURE

    def stamp(self, arrival: float) -> float:
        """[s] for a sample that arrived at `arrival` [s]; grows from one to the next."""
        gap = arrival - self._phase
        if self._count and abs(gap) > _LOST * max(self._period, self._jitter):
            self._count = 0
            self._first.clear()
        if self._count:
            self._follow(gap)
        else:
            self._begin(arrival)
        self._last = max(self._phase, self._last + _APART)
        return self._last

    def _follow(self, gap: float) -> None:
        self._count += 1
        k, period = self._count, self._period
        steps = 1 + self._missed(gap - period)
        error = min(max(gap - steps * period, -0.5 * period), 0.5 * period)
        floor = _LEAST**2 / (2.0 - _LEAST)
        gain = max(2.0 * (2.0 * k - 1.0) / (k * (k + 1.0)), _LEAST)
        self._phase += steps * period + gain * error
        self._period += max(6.0 / (k * (k + 1.0)), floor) * error / max(steps, 1)

    def _missed(self, error: float) -> int:
        """Periods by which the line is behind (above 0) or ahead, as the last errors [s] tell."""
        for sign, errors in ((1, self._behind), (-1, self._ahead)):
            errors.append(sign * error)
            scale = self._period / self._jitter**2
            score = scale * (sum(errors) - 0.5 * self._period * len(errors))
            if score <= 0.0:
                errors.clear()
            elif score > _SURE:
                missed = sign * max(1, round(fmean(errors) / self._period))
                self._forget_errors()
                return missed
        self._since += 1
        return 0

    def _forget_errors(self) -> None:
        self._behind: list[float] = []
        self._ahead: list[float] = []
        self._since = 0

    def _begin(self, arrival: float) -> None:
        """Draw the line through the first arrivals."""
        self._phase = arrival
        self._first.append(arrival)
        if len(self._first) < _FIRST:
            return
        numbers = _numbers([b - a for a, b in pairwise(self._first)], _LATE * self._jitter)
        self._period, start = linear_regression(numbers, self._first)
        self._period = max(self._period, _APART)
        self._phase = start + self._period * numbers[-1]
        self._count = _FIRST
        self._forget_errors()


def _numbers(gaps: Sequence[float], late: float) -> list[int]:
    """Numbers of samples from gaps [s]; one longer than usual by `late` [s] follows lost ones."""
    usual = max(median(gaps), _APART)
    steps = (max(1, round(gap / usual)) if gap > usual + late else 1 for gap in gaps)
    return list(accumulate(steps, initial=0))

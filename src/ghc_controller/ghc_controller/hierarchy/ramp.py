"""A ramp from the current mixture to a target, with a bounded number of candidates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.types import Array

MOST_CANDIDATES = 4  # in force at a time: each costs one solve of a blend per step


class Ramp:
    """Shares that move continuously to `target` as the progress goes from 0 to 1.

    Equal matrices share one entry. A ramp that would need more than MOST_CANDIDATES first moves
    the smallest share to the others, at the speed of the ramp, and only then adds the target:
    shares are continuous, and repeated preemption costs at most MOST_CANDIDATES solves.
    """

    def __init__(self, initial: Sequence[Candidate], target: Array) -> None:
        """Leave the mixture `initial` for `target` (k, k)."""
        others = [c for c in initial if not np.array_equal(c.alpha, target)]
        same = [c for c in initial if np.array_equal(c.alpha, target)]
        self.matrices = tuple(np.array(alpha) for alpha in (*(c.alpha for c in others), target))
        shares = np.array([c.share for c in others] + [sum(c.share for c in same)])
        self._initial: list[float] = (shares / shares.sum()).tolist()
        crowded = len(self.matrices) > MOST_CANDIDATES
        self._leaving = int(np.argmin(self._initial[:-1])) if crowded else -1
        self.first_part = self._initial[self._leaving] if crowded else 0.0

    def part_end(self, progress: float) -> float:
        """End of the current segment, in which the shares are linear in the progress."""
        return self.first_part if progress < self.first_part else 1.0

    def shares(self, progress: float) -> Array:
        """(c,) shares of `matrices`, at a progress in [0, 1]."""
        return np.array(self._shares_at(progress))

    def at(self, progress: float) -> tuple[Candidate, ...]:
        """Mixture at that progress, without candidates whose share is zero."""
        return tuple(Candidate(*pair) for pair in zip(*self.mixture(progress), strict=True))

    def mixture(self, progress: float) -> tuple[tuple[Array, ...], tuple[float, ...]]:
        """The same as matrices and shares; all of them are the same tuple every time."""
        if len(self._initial) == 2 and 0.0 < progress < 1.0 and self._initial[0] > 0.0:
            # As below, without its lists.
            left = 1.0 - progress
            first, last = self._initial
            return self.matrices, (left * first, left * last + progress)
        shares = self._shares_at(progress)
        if min(shares) > 0.0:
            return self.matrices, tuple(shares)
        pairs = [pair for pair in zip(self.matrices, shares, strict=True) if pair[1] > 0.0]
        return tuple(alpha for alpha, _ in pairs), tuple(share for _, share in pairs)

    def _shares_at(self, progress: float) -> list[float]:
        """As numbers: arrays of two to five take ten times as long."""
        shares = list(self._initial)
        if self._leaving >= 0:
            left = max(self.first_part - progress, 0.0)
            scale = (1.0 - left) / (1.0 - self.first_part)
            shares = [scale * share for share in shares]
            shares[self._leaving] = left
            progress = max(progress - self.first_part, 0.0) / (1.0 - self.first_part)
        shares = [(1.0 - progress) * share for share in shares]
        shares[-1] += progress
        return shares


@dataclass(frozen=True, slots=True, eq=False)
class PacedPriorities(Priorities):
    """Priorities of a ramp with a torque-rate budget; its progress depends on the solutions.

    `candidates` are those of the current segment, including the target even while its share is
    zero; `alpha` and the shares are those at progress `before`.
    """

    ramp: Ramp
    before: float  # [-] progress at the end of the last step
    cap: float  # [-] progress that the duration allows
    step: float  # [Nm] largest change of a torque by the ramp in one control period

    @classmethod
    def on(cls, ramp: Ramp, before: float, cap: float, step: float) -> PacedPriorities:
        """Priorities of a step that starts at the progress `before`."""
        now = Priorities.mixed(ramp.at(before))
        kept = _matrices_between(ramp, before)
        shares = ramp.shares(before)
        candidates = tuple(Candidate(ramp.matrices[c], float(shares[c])) for c in kept)
        return cls(now.alpha, candidates, ramp, before, cap, step)

    def progress(self, torques: Sequence[Array]) -> float:
        """Progress at which no torque has moved by more than `step` since `before`.

        A blend is linear in the shares, so the largest progress has a closed form: it advances
        by step / max_j |d tau_j / d progress|.

        Args:
            torques: solution (a,) of each candidate, all at the state of this step [Nm].
        """
        end = min(self.ramp.part_end(self.before), self.cap)
        if end <= self.before:
            return self.before
        kept = _matrices_between(self.ramp, self.before)
        change = (self.ramp.shares(end) - self.ramp.shares(self.before))[kept]
        moved = float(np.abs(change @ np.asarray(torques)).max(initial=0.0))
        if not np.isfinite(moved):
            return self.before
        way = 1.0 if moved <= self.step else self.step / moved
        return end if way >= 1.0 else self.before + way * (end - self.before)

    def shares_at(self, progress: float) -> Array:
        """(c,) shares of `candidates` at a progress in this segment."""
        return self.ramp.shares(progress)[_matrices_between(self.ramp, self.before)]


def _matrices_between(ramp: Ramp, before: float) -> list[int]:
    """Indices of the matrices with a share in the segment after `before`."""
    begin, end = ramp.shares(before), ramp.shares(ramp.part_end(before))
    return [c for c in range(len(begin)) if begin[c] > 0.0 or end[c] > 0.0]

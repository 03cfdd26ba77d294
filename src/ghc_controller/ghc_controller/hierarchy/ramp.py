"""A ramp from the mixture in force to a target, with a bounded number of candidates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.types import Array

MOST_CANDIDATES = 4  # in force at a time: each costs one solve of a blend per step


class Ramp:
    """Shares that move to `target` as the progress goes from 0 to 1, without a jump.

    Matrices that equal each other share one entry. A ramp that would hold more than
    MOST_CANDIDATES first hands the smallest share to the others, at the speed of the ramp, and
    only then lets the target in: shares are continuous, and pre-empting again and again costs no
    more than MOST_CANDIDATES solves.
    """

    def __init__(self, initial: Sequence[Candidate], target: Array) -> None:
        """Leave the mixture `initial` for `target` (k, k)."""
        others = [c for c in initial if not np.array_equal(c.alpha, target)]
        same = [c for c in initial if np.array_equal(c.alpha, target)]
        self.matrices = tuple(np.array(alpha) for alpha in (*(c.alpha for c in others), target))
        shares = np.array([c.share for c in others] + [sum(c.share for c in same)])
        self._shares = shares / shares.sum()
        crowded = len(self.matrices) > MOST_CANDIDATES
        self._leaving = int(np.argmin(self._shares[:-1])) if crowded else -1
        self.first_part = float(self._shares[self._leaving]) if crowded else 0.0

    def part_end(self, progress: float) -> float:
        """Progress up to which the shares are linear from here."""
        return self.first_part if progress < self.first_part else 1.0

    def shares(self, progress: float) -> Array:
        """(c,) shares of `matrices`, at a progress in [0, 1]."""
        shares = self._shares.copy()
        if self._leaving >= 0:
            left = max(self.first_part - progress, 0.0)
            shares *= (1.0 - left) / (1.0 - self.first_part)
            shares[self._leaving] = left
            progress = max(progress - self.first_part, 0.0) / (1.0 - self.first_part)
        shares *= 1.0 - progress
        shares[-1] += progress
        return shares

    def at(self, progress: float) -> tuple[Candidate, ...]:
        """Mixture at that progress, without candidates whose share is zero."""
        pairs = zip(self.matrices, self.shares(progress), strict=True)
        return tuple(Candidate(alpha, float(share)) for alpha, share in pairs if share > 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class PacedPriorities(Priorities):
    """Priorities of a ramp with a torque-rate budget; how far it goes depends on the answers.

    `candidates` are those of the part of the ramp under way, the target among them even while
    its share is zero; `alpha` and the shares are those of `before`.
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
            torques: answer (a,) of each of `candidates`, all at the state of this step [Nm].
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
        """(c,) shares of `candidates` at a progress of this part of the ramp."""
        return self.ramp.shares(progress)[_matrices_between(self.ramp, self.before)]


def _matrices_between(ramp: Ramp, before: float) -> list[int]:
    """Indices of the matrices that have a share in the part of the ramp after `before`."""
    begin, end = ramp.shares(before), ramp.shares(ramp.part_end(before))
    return [c for c in range(len(begin)) if begin[c] > 0.0 or end[c] > 0.0]

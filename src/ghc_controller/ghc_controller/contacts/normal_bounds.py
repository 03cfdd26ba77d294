"""Bounds on normal forces, and the transition from current bounds to a late plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array

# Duration of the transition in units of the delay. Until a late plan arrives, the bounds follow
# the previous plan, so the gap is what both differ by over the delay. Closing it over ten times
# the delay adds at most a tenth to the rates of the plans.
WAY_PER_DELAY = 10.0  # [-]


@dataclass(frozen=True, slots=True)
class NormalBounds:
    """F_lower <= F_n <= F_upper of every contact (thesis, eq. 5.5), and the active contacts."""

    lower: Array  # (c,) [N]
    upper: Array  # (c,) [N]
    active: tuple[bool, ...]  # (c,)
    stale: tuple[str, ...]  # contacts whose plan has ended


@dataclass(frozen=True, slots=True)
class Way:
    """Remaining gap between current bounds and plan, which decreases to zero at `end`.

    Only bounds tighter than the plan approach it gradually. Looser bounds change at once, since
    the plan may lie on the raw bound: no bound is ever looser than the plan.
    """

    begin: float  # [s]
    end: float  # [s]
    lower: Array  # (c,) [N] >= 0, added to the plan's lower bounds at `begin`
    upper: Array  # (c,) [N] <= 0, added to the upper bounds

    @classmethod
    def begun(
        cls, now: float, delay: float, in_force: NormalBounds, plan: NormalBounds, old: Way | None
    ) -> Way | None:
        """Transition from the current bounds at `now` [s] to those of a plan; None = no gap.

        `delay` [s] is that of the plan. During an `old` transition only the growth of the gap
        takes additional time: if each plan is late but equal to the one before, the old
        transition is completed.
        """
        lower = np.maximum(in_force.lower - plan.lower, 0.0)
        upper = np.minimum(in_force.upper - plan.upper, 0.0)
        gap = np.concatenate([lower, -upper])
        widest = gap.max(initial=0.0)
        if widest == 0.0:
            return None
        left = 0.0 if old is None else old.left(now)
        grown = gap if old is None else gap - left * np.concatenate([old.lower, -old.upper])
        new = min(np.abs(grown).max() / widest, 1.0)
        remaining = old.end - now if old is not None and left > 0.0 else 0.0
        return cls(now, now + max(remaining, WAY_PER_DELAY * delay * new), lower, upper)

    def left(self, time: float) -> float:
        """Remaining fraction of the gap at `time` [s]."""
        share = (self.end - time) / (self.end - self.begin) if self.end > self.begin else 0.0
        return min(max(share, 0.0), 1.0)

    def narrow(self, time: float, lower: Array, upper: Array) -> None:
        """Add the remaining gap at `time` [s] to bounds (c,) of the plan, in place."""
        left = self.left(time)
        if left == 0.0:
            return
        np.maximum(lower, upper + left * self.upper, out=upper)
        np.minimum(lower + left * self.lower, upper, out=lower)

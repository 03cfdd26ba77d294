"""Bounds on normal forces, and the way from those in force to a plan that comes late."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array

# How long the way is, in units of the delay. While a plan is under way the bounds go on as the
# plan before says, so the gap is what both differ in over the delay: over ten times that it adds
# at most a tenth to the rates of the plans.
WAY_PER_DELAY = 10.0  # [-]


@dataclass(frozen=True, slots=True)
class NormalBounds:
    """F_lower <= F_n <= F_upper of every contact (thesis, eq. 5.5), and which contacts are on."""

    lower: Array  # (c,) [N]
    upper: Array  # (c,) [N]
    active: tuple[bool, ...]  # (c,)
    stale: tuple[str, ...]  # contacts whose plan has ended


@dataclass(frozen=True, slots=True)
class Way:
    """What is left of the gap between bounds in force and plan, smaller and smaller until `end`.

    Only bounds that are tighter than the plan wait for it to come near. What is looser is given
    up at once, since the raw bound may lie on the plan: so nothing is ever looser than the plan.
    """

    begin: float  # [s]
    end: float  # [s]
    lower: Array  # (c,) [N] 0 or more, added to the plan's lower bounds at `begin`
    upper: Array  # (c,) [N] 0 or less, added to the upper ones

    @classmethod
    def begun(
        cls, now: float, delay: float, in_force: NormalBounds, plan: NormalBounds, old: Way | None
    ) -> Way | None:
        """Way from the bounds in force at `now` [s] to those that a plan has then; None = there.

        `delay` [s] is that of the plan. With an `old` way under way only what the gap has grown
        takes time of its own: where each plan is late, but says the same as the one before, the
        old way is gone to its end.
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
        """Share of the way that is left at `time` [s]."""
        share = (self.end - time) / (self.end - self.begin) if self.end > self.begin else 0.0
        return min(max(share, 0.0), 1.0)

    def narrow(self, time: float, lower: Array, upper: Array) -> None:
        """Move bounds (c,) of the plan at `time` [s], in place, to where they are on the way."""
        left = self.left(time)
        if left == 0.0:
            return
        np.maximum(lower, upper + left * self.upper, out=upper)
        np.minimum(lower + left * self.lower, upper, out=lower)

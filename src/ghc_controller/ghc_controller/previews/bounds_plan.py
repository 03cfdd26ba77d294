"""The whole plan of the force bounds of one tick, as it travels to the controller."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from enum import Enum
from itertools import compress

import numpy as np
from numba import njit

from ghc_controller.types import Array


class PlanStatus(Enum):
    """How the plan of a contact came about; the value travels in messages."""

    SMOOTHED = 0  # the optimum of the preview
    RAW = 1  # passed through (smoothing off)
    HELD = 2  # no solution: the plan before, as far as it goes, inside the raw bounds
    TIGHTENED = 3  # no solution and no plan left: towards the tightest bound ahead


@dataclass(frozen=True, slots=True)
class ForceBoundsPlan:
    """Bounds of c contacts at the points start + j step, j = 0 .. N."""

    start: float  # [s] time of the tick
    step: float  # [s] between points
    contacts: tuple[str, ...]
    lower: Array  # (c, N + 1) [N]
    upper: Array  # (c, N + 1) [N]
    in_contact: tuple[bool, ...]  # whether the schedule allows a force now
    status: tuple[PlanStatus, ...]
    conflict: tuple[bool, ...]  # the schedule contradicts itself within the horizon
    smoothed: bool  # false: each point holds until the next one; true: straight lines between

    @property
    def valid_until(self) -> float:
        """End of the plan [s]."""
        return self.start + self.step * (self.lower.shape[1] - 1)

    @property
    def is_empty(self) -> bool:
        """True when no contact has a bound."""
        return not self.contacts

    def at(self, time: float) -> tuple[Array, Array]:
        """Lower and upper bounds (c,) [N] at a time [s]; the ends are held outside the plan."""
        return bounds_at(self.lower, self.upper, (time - self.start) / self.step, self.smoothed)

    def without(self, names: Collection[str]) -> ForceBoundsPlan:
        """The plan of the contacts that have none of these names."""
        kept = np.array([name not in names for name in self.contacts], dtype=np.bool_)
        return replace(
            self,
            contacts=tuple(compress(self.contacts, kept)),
            lower=self.lower[kept],
            upper=self.upper[kept],
            in_contact=tuple(compress(self.in_contact, kept)),
            status=tuple(compress(self.status, kept)),
            conflict=tuple(compress(self.conflict, kept)),
        )

    @property
    def first_rates(self) -> tuple[Array, Array]:
        """The inputs that are applied: rates (c,) [N/s] of lower and upper over the first step."""
        lower, upper = (
            (values[:, 1] - values[:, 0]) / self.step for values in (self.lower, self.upper)
        )
        return lower, upper


@njit(cache=True)
def bounds_at(
    lower: Array, upper: Array, place: float, smoothed: bool
) -> tuple[Array, Array]:  # pragma: no cover
    """Bounds (c,) at a place [points from the first] of points lower, upper (c, N + 1).

    Straight lines between points, or each point until the next one.
    """
    if not smoothed:
        place = np.floor(place + 1e-6)
    place = min(max(place, 0.0), lower.shape[1] - 1.0)
    left = min(int(place), lower.shape[1] - 2)
    share = place - left
    low, high = np.empty(lower.shape[0]), np.empty(lower.shape[0])
    for k in range(lower.shape[0]):
        low[k] = (1.0 - share) * lower[k, left] + share * lower[k, left + 1]
        high[k] = (1.0 - share) * upper[k, left] + share * upper[k, left + 1]
    return low, high

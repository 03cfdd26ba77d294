"""Several boxes on the same quantity merged into one, with the names of who binds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, SupportsIndex

import numba
import numpy as np
from numpy.typing import NDArray

from ghc_controller.types import Array, Bounds

NO_SOURCE = -1  # in lower_source and upper_source: the entry has no bound on this side


class Slack(NamedTuple):
    """A bound that gave way to harder ones."""

    name: str  # constraint and entry, such as "velocity_limit.joint_3"
    amount: float  # [rad/s^2] or [Nm] distance of the merged box from the bound


@dataclass(slots=True)
class Box:
    """Merged bounds of r entries; lower <= upper always.

    ConstraintSet overwrites its boxes every tick: copy what must outlive the tick.
    """

    bounds: Bounds  # (r,)
    hard: Bounds  # (r,) of the HARD constraints alone: what is left when all others give way
    lower_source: NDArray[np.int64]  # (r,) index into `names`, NO_SOURCE without a bound
    upper_source: NDArray[np.int64]  # (r,)
    slack: tuple[Slack, ...]  # empty in all but conflicting ticks
    names: tuple[str, ...]  # constraints, softest last
    entries: tuple[str, ...]  # (r,) names of the entries

    def lower_name(self, entry: SupportsIndex) -> str:
        """Name of the row behind the lower bound of an entry, "" without one."""
        return self._name(int(self.lower_source[entry]), entry.__index__())

    def upper_name(self, entry: SupportsIndex) -> str:
        """Name of the row behind the upper bound of an entry, "" without one."""
        return self._name(int(self.upper_source[entry]), entry.__index__())

    def active(self, values: Array, tolerance: float = 1e-6) -> tuple[str, ...]:
        """Names of the rows at (or beyond) their bound at `values` (r,), within `tolerance`."""
        at_lower = values <= self.bounds.lower + tolerance
        at_upper = values >= self.bounds.upper - tolerance
        if not (at_lower.any() or at_upper.any()):
            return ()
        names = [self.lower_name(entry) for entry in np.flatnonzero(at_lower)]
        names += [self.upper_name(entry) for entry in np.flatnonzero(at_upper)]
        return tuple(dict.fromkeys(names))

    def _name(self, source: int, entry: int) -> str:
        return "" if source == NO_SOURCE else f"{self.names[source]}.{self.entries[entry]}"


@numba.njit(cache=True)
def merge_boxes(
    lowers: Array,
    uppers: Array,
    hard_count: int,
    merged: Array,
    sources: NDArray[np.int64],
    slack: Array,
) -> bool:
    """Intersect c boxes over r entries, hardest first.

    Where the next box misses what is left, it gives way: the merged box becomes the one point
    nearest to it, and the distance is its slack.

    Args:
        lowers, uppers: (c, r) boxes, hardest first.
        hard_count: how many of them are hard.
        merged: (4, r) written: lower, upper, lower and upper of the hard boxes alone.
        sources: (2, r) written: index of the box behind lower and upper, NO_SOURCE for none.
        slack: (c, r) written, >= 0.

    Returns:
        True when any box gave way.
    """
    gave_way = False
    count, entries = lowers.shape
    for entry in range(entries):
        low, high = -np.inf, np.inf
        low_source, high_source = NO_SOURCE, NO_SOURCE
        merged[2, entry], merged[3, entry] = low, high
        for c in range(count):
            slack[c, entry] = 0.0
            lower, upper = lowers[c, entry], uppers[c, entry]
            if lower > high:
                slack[c, entry] = lower - high
                low, low_source = high, c
                gave_way = True
            elif upper < low:
                slack[c, entry] = low - upper
                high, high_source = low, c
                gave_way = True
            else:
                if lower > low:
                    low, low_source = lower, c
                if upper < high:
                    high, high_source = upper, c
            if c < hard_count:
                merged[2, entry], merged[3, entry] = low, high
        merged[0, entry], merged[1, entry] = low, high
        sources[0, entry], sources[1, entry] = low_source, high_source
    return gave_way

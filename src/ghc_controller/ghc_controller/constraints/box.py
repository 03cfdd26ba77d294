"""Several boxes on the same quantity merged into one, with the names of the active bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from ghc_controller.types import Array, Bounds

NO_SOURCE = -1  # in lower_source and upper_source: the entry has no bound on this side


class Slack(NamedTuple):
    """A relaxed bound."""

    name: str  # constraint and entry, such as "velocity_limit.joint_3"
    amount: float  # [rad/s^2] or [Nm] distance of the merged box from the bound


@dataclass(slots=True)
class Box:
    """Merged bounds of r entries; lower <= upper always.

    ConstraintSet overwrites its boxes every tick: copy what must outlive the tick.
    """

    bounds: Bounds  # (r,)
    hard: Bounds  # (r,) of the HARD constraints only, if all others are relaxed
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

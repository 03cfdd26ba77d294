"""A schedule over a horizon: raw bounds at its points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ghc_controller.types import Array
from ghc_mpc_constraints.previews.horizon import STEP_TOLERANCE, Horizon
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule


@dataclass(frozen=True, slots=True)
class RawBounds:
    """Raw bounds of one row at the N + 1 points of a horizon, made consistent."""

    lower: Array  # (N + 1,)
    upper: Array  # (N + 1,), lower <= upper everywhere
    conflict: bool  # lower > upper somewhere in the schedule: the upper one was kept


def preview(schedule: LimitSchedule, start: float, horizon: Horizon) -> RawBounds:
    """Bounds whose linear interpolation between points stays inside the schedule.

    Each point uses the tighter bound of its two adjacent steps, so that an interpolated bound is
    never looser than the raw one, wherever that jumps. If the two steps are incompatible, the
    point uses the schedule at its own time. If that is inconsistent, the upper bound is kept: it
    is the limit of the environment, and zero without contact.
    """
    times = horizon.times(start)
    slack = STEP_TOLERANCE * horizon.step  # a jump at a point belongs to the step after it
    index = np.searchsorted(schedule.times, times + slack, side="right") - 1
    last = np.searchsorted(schedule.times, times + horizon.step - slack, side="left") - 1
    index, last = np.maximum(index, 0), np.maximum(last, 0)  # the first entry applies before, too
    after = _extremes(schedule, index, last)
    before = [np.concatenate([value[:1], value[:-1]]) for value in after]
    lower, upper = np.maximum(before[0], after[0]), np.minimum(before[1], after[1])
    own_lower, own_upper = schedule.lower[index], schedule.upper[index]
    torn = lower > upper
    lower[torn], upper[torn] = own_lower[torn], own_upper[torn]
    conflict = bool((lower > upper).any())
    return RawBounds(np.minimum(lower, upper), upper, conflict)


def _extremes(
    schedule: LimitSchedule, first: NDArray[np.intp], last: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Largest lower and smallest upper bound of the entries first .. last, per point."""
    lower, upper = schedule.lower[first].copy(), schedule.upper[first].copy()
    for point in np.flatnonzero(last > first):  # rare: a jump inside a step
        inside = slice(first[point], last[point] + 1)
        lower[point] = schedule.lower[inside].max()
        upper[point] = schedule.upper[inside].min()
    return lower, upper

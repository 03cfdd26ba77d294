"""What a jump of a constraint costs, and how well the bounds were kept; no ROS, no files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ghc_controller.types import Array
from ghc_sim_bridge.analysis.metrics import peak_torque_rate
from ghc_sim_bridge.logs.constraint_series import FORCE, LOWER, UPPER, ConstraintSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.schedules import Event

REACH = 2.0  # [s] of an event before and after it: longer than preview and reaction take
_SAME_TIME = 1e-6  # [s]


@dataclass(frozen=True, slots=True)
class ForceFollowing:
    """One contact over a run: the QP's force against its bounds, the simulation's against both."""

    qp_violation: float  # [N] largest excess of the QP's force over its bounds
    difference_rms: float  # [N] of simulated and asked force, while in contact
    difference_largest: float  # [N]
    above_upper: float  # [N] largest excess of the simulated force over the bound in force


def event_windows(
    events: Sequence[Event], duration: float, reach: float = REACH
) -> tuple[tuple[float, float], ...]:
    """Time around each event [s], at most `reach` to both sides and no farther than half-way.

    A smoothed constraint moves before an announced event and after one that is measured: peaks
    are looked for over the same window without and with smoothing.
    """
    times = [event.time for event in events]
    middles = [0.5 * (a + b) for a, b in pairwise(times)]
    starts = [0.0, *middles]
    ends = [*middles, duration]
    return tuple(
        (max(start, time - reach), min(end, time + reach))
        for time, start, end in zip(times, starts, ends, strict=True)
    )


def event_peaks(log: FullRateLog, windows: Sequence[tuple[float, float]]) -> tuple[float, ...]:
    """Largest torque rate of any joint in each window [Nm/s], at the log's control period."""
    if not windows:
        return ()
    return peak_torque_rate(log.time, log.torque, log.control_dt, windows).per_phase


def force_following(
    series: ConstraintSeries, name: str, time: Array, force: Array
) -> ForceFollowing:
    """How a contact's bounds were kept; `force` (T,) [N] is the simulated one at `time` (T,) [s].

    The force commanded at t acts over the next period and is measured at its end.
    """
    values = series.contacts[name]
    present = np.isfinite(values).all(axis=1)
    lower, upper, asked = (values[present, k] for k in (LOWER, UPPER, FORCE))
    if not present.any():
        return ForceFollowing(0.0, 0.0, 0.0, 0.0)
    rows = np.searchsorted(time, series.time[present] - _SAME_TIME) + 1
    rows = np.minimum(rows, len(time) - 1)
    sensed = force[rows]
    on = upper > 0.0
    difference = np.abs(sensed - asked)[on]
    return ForceFollowing(
        qp_violation=largest(np.maximum(lower - asked, asked - upper)),
        difference_rms=float(np.sqrt(np.mean(difference**2))) if on.any() else 0.0,
        difference_largest=largest(difference),
        above_upper=largest((sensed - upper)[on]),
    )


def ratios(without: Sequence[float], with_them: Sequence[float]) -> tuple[float, ...]:
    """How many times larger each figure is without generators; inf where it is 0 with them."""
    return tuple(
        a / b if b > 0.0 else float("inf") for a, b in zip(without, with_them, strict=True)
    )


def largest(excess: Array) -> float:
    """Largest entry above 0, else 0; NaN is passed over."""
    return float(np.nanmax(excess, initial=0.0))

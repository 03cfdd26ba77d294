"""Figures of one run, computed from the bridge's full-rate log; no ROS, no files.

T rows of period dt, n joints. Row k of the log holds the state at t_k and the torque applied over
[t_k, t_k + dt), so a torque jump at row k is the step from row k - 1 to row k.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class PhasedFigure:
    """A figure over the whole run and for each phase."""

    total: float
    per_phase: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """One kind of limit on a signal: lower <= signal <= upper, entry by entry."""

    name: str
    signal: Array  # (T, n)
    lower: Array  # (n,) or (T, n)
    upper: Array  # (n,) or (T, n)


def torque_jumps(torque: Array) -> Array:
    """Largest step of any joint from the row before, (T,) [Nm]; 0 in the first row."""
    steps = np.abs(np.diff(torque, axis=0)).max(axis=1)
    return np.concatenate(([0.0], steps))


def peak_torque_jump(
    time: Array, torque: Array, spans: Sequence[tuple[float, float]]
) -> PhasedFigure:
    """Largest torque step of any joint between two control periods [Nm].

    `spans` are the phases' starts and ends [s]; the step into a phase's first row is its own.
    """
    return _over_phases(time, torque_jumps(torque), spans, np.max)


def peak_torque_rate(
    time: Array, torque: Array, control_dt: float, spans: Sequence[tuple[float, float]]
) -> PhasedFigure:
    """Largest torque step over the control period [Nm/s]: meaningless without that period."""
    jumps = peak_torque_jump(time, torque, spans)
    per_phase = tuple(jump / control_dt for jump in jumps.per_phase)
    return PhasedFigure(jumps.total / control_dt, per_phase)


def jerk_steps(acceleration: Array) -> Array:
    """Sum over the joints of |acceleration step|, (T,) [rad/s^2]; 0 in the first row."""
    return np.concatenate(([0.0], np.abs(np.diff(acceleration, axis=0)).sum(axis=1)))


def jerk_integral(
    time: Array, acceleration: Array, spans: Sequence[tuple[float, float]]
) -> PhasedFigure:
    """Figure 5 of the GHC paper: sum over the joints of the integral of |jerk| [rad/s^2].

    The acceleration is constant over a control period, so the integral is the sum of its steps.
    """
    return _over_phases(time, jerk_steps(acceleration), spans, np.sum)


def phase_end_speed(
    time: Array, velocity: Array, spans: Sequence[tuple[float, float]], window: float = 1.0
) -> PhasedFigure:
    """Largest joint speed over the last `window` [s] of each phase [rad/s]: 0 = at rest.

    Task errors can be constant while the arm still swings in directions that they do not see.
    """
    tails = [(max(start, end - window), end) for start, end in spans]
    return _over_phases(time, np.abs(velocity).max(axis=1), tails, np.max)


def relative_excess(check: LimitCheck) -> Array:
    """Largest excess of each column over its limit, as a fraction of that limit, (n,) [-].

    0 where the limit holds. A bound of 0 is measured against half the width of its range.
    """
    lower = np.broadcast_to(check.lower, check.signal.shape)
    upper = np.broadcast_to(check.upper, check.signal.shape)
    half = 0.5 * (upper - lower)
    below = _fraction(lower - check.signal, lower, half)
    above = _fraction(check.signal - upper, upper, half)
    return np.maximum(below, above).max(axis=0, initial=0.0)


def limit_violations(checks: Sequence[LimitCheck]) -> dict[str, float]:
    """Largest relative excess per kind of limit [-]; 0 = never exceeded."""
    return {check.name: float(relative_excess(check).max(initial=0.0)) for check in checks}


def percentiles(seconds: Sequence[float]) -> Mapping[str, float | None]:
    """Median, 99th percentile and maximum of wall times [s], in microseconds."""
    if not seconds:
        return {"p50": None, "p99": None, "max": None}
    p50, p99 = np.percentile(seconds, [50.0, 99.0])
    return {
        name: round(float(value) * 1e6, 3)
        for name, value in (("p50", p50), ("p99", p99), ("max", max(seconds)))
    }


def _fraction(excess: Array, bound: Array, half: Array) -> Array:
    """max(excess, 0) over |bound|; 0 where there is no bound."""
    size = np.where(bound == 0.0, half, np.abs(bound))
    exceeded = np.isfinite(bound) & (excess > 0.0)
    return np.divide(excess, size, out=np.zeros_like(excess), where=exceeded)


def _over_phases(
    time: Array,
    values: Array,
    spans: Sequence[tuple[float, float]],
    reduce: Callable[[Array], float],
) -> PhasedFigure:
    """Reduce the rows of each span [start, end); the last span takes its end as well."""
    figures = []
    tolerance = 1e-9
    for start, end in spans:
        last = end == spans[-1][1]
        inside = (time > start - tolerance) & ((time < end - tolerance) | last)
        figures.append(float(reduce(values[inside])) if inside.any() else 0.0)
    return PhasedFigure(float(reduce(np.asarray(figures))), tuple(figures))

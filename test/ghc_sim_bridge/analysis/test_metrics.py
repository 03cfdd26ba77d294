"""Figures of signals whose figures are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_sim_bridge.analysis.metrics import (
    LimitCheck,
    jerk_integral,
    limit_violations,
    peak_torque_jump,
    peak_torque_rate,
    percentiles,
    phase_end_speed,
    relative_excess,
)

DT = 1e-3
TIME = np.arange(10_000) * DT
SPANS = [(0.0, 4.0), (4.0, 10.0)]


def test_sinusoidal_torque_has_the_rate_of_its_derivative() -> None:
    amplitude, rate = 3.0, 2.0
    torque = np.column_stack([amplitude * np.sin(rate * TIME), 0.0 * TIME])
    figure = peak_torque_rate(TIME, torque, DT, SPANS)
    assert figure.total == pytest.approx(amplitude * rate, rel=1e-5)
    assert figure.per_phase == pytest.approx((amplitude * rate,) * 2, rel=1e-5)


def test_a_step_belongs_to_the_phase_in_which_its_torque_is_applied() -> None:
    torque = np.zeros((len(TIME), 3))
    torque[TIME >= 4.0 - 1e-9, 1] = -7.5
    jump = peak_torque_jump(TIME, torque, SPANS)
    assert jump.per_phase == (0.0, 7.5)
    assert jump.total == 7.5


def test_the_rate_of_a_step_grows_as_the_period_shrinks_and_its_jump_does_not() -> None:
    torque = np.zeros((len(TIME), 1))
    torque[5000:] = 2.0
    fine, coarse = (peak_torque_rate(TIME, torque, dt, SPANS).total for dt in (1e-4, 1e-3))
    assert fine == pytest.approx(10.0 * coarse)
    assert peak_torque_jump(TIME, torque, SPANS).total == 2.0


def test_peaks_take_the_largest_and_the_jerk_integral_the_sum_of_the_phases() -> None:
    signal = np.random.default_rng(3).normal(size=(len(TIME), 4))
    jump = peak_torque_jump(TIME, signal, SPANS)
    jerk = jerk_integral(TIME, signal, SPANS)
    assert jump.total == max(jump.per_phase)
    assert jerk.total == pytest.approx(sum(jerk.per_phase))
    assert jerk.total == pytest.approx(np.abs(np.diff(signal, axis=0)).sum())


def test_jerk_integral_of_a_sinusoid_is_its_total_variation() -> None:
    # |d/dt sin(2 pi t)| integrates to 4 over each period; two joints, ten periods.
    acceleration = np.column_stack([np.sin(2 * np.pi * TIME), np.sin(2 * np.pi * TIME)])
    assert jerk_integral(TIME, acceleration, SPANS).total == pytest.approx(2 * 4 * 10, rel=1e-3)


def test_jerk_integral_does_not_depend_on_the_sampling() -> None:
    coarse = TIME[::10]
    fine_value = jerk_integral(TIME, np.cos(TIME)[:, None], SPANS).total
    coarse_value = jerk_integral(coarse, np.cos(coarse)[:, None], SPANS).total
    assert coarse_value == pytest.approx(fine_value, rel=1e-2)


def test_the_end_speed_sees_only_the_last_second_of_a_phase() -> None:
    velocity = np.zeros((len(TIME), 2))
    velocity[TIME < 2.9, 0] = 5.0  # over before the last second of the first phase
    velocity[TIME >= 9.5, 1] = -0.25
    speed = phase_end_speed(TIME, velocity, SPANS)
    assert speed.per_phase == (0.0, 0.25)
    assert speed.total == 0.25


def test_excess_is_a_fraction_of_the_limit_on_either_side() -> None:
    signal = np.array([[0.0, -1.3], [2.2, 0.5]])
    check = LimitCheck("velocity", signal, np.array([-2.0, -1.0]), np.array([2.0, 1.0]))
    assert relative_excess(check) == pytest.approx([0.1, 0.3])


def test_no_excess_inside_the_limits_or_without_any() -> None:
    signal = np.random.default_rng(5).uniform(-1.0, 1.0, size=(50, 3))
    inside = LimitCheck("torque", signal, -np.ones(3), np.ones(3))
    unlimited = LimitCheck("rate", 1e9 * signal, np.full(3, -np.inf), np.full(3, np.inf))
    assert limit_violations([inside, unlimited]) == {"torque": 0.0, "rate": 0.0}


def test_bounds_may_move_with_time_and_be_zero() -> None:
    center = np.linspace(-5.0, 5.0, 11)[:, None]
    held = LimitCheck("bound", center + 1.4, center - 1.5, center + 1.5)
    assert relative_excess(held) == pytest.approx([0.0])
    zero = LimitCheck("position", np.array([[-0.1]]), np.array([0.0]), np.array([2.0]))
    assert relative_excess(zero) == pytest.approx([0.1])  # of half the range


def test_percentiles_are_microseconds_and_empty_without_samples() -> None:
    assert percentiles([1e-4] * 99 + [1e-3]) == {
        "p50": 100.0,
        "p99": pytest.approx(109.0),
        "max": 1000.0,
    }
    assert percentiles([]) == {"p50": None, "p99": None, "max": None}

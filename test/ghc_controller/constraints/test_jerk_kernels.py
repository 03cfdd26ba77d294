"""Bounds of one joint with bounded jerk: rolled out, they keep its limits and can be followed."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.core import (
    position_bound,
    stopping_distance,
    velocity_bound,
)

DT = 1e-3  # [s]
BRAKE = 5.0  # [rad/s^2]


@pytest.mark.parametrize("seed", range(20))
def test_stopping_distance_is_that_of_the_rolled_out_motion(seed: int) -> None:
    """Integrated in steps of 10 us until the speed is zero."""
    rng = np.random.default_rng(seed)
    jerk, step = float(rng.uniform(20.0, 500.0)), 1e-5
    v, a = float(rng.uniform(0.05, 2.0)), float(rng.uniform(-7.0, 20.0))
    expected, travel, speed = stopping_distance(v, a, jerk, BRAKE), 0.0, v
    if a < -BRAKE:
        a = -BRAKE
    while speed > 0.0:
        travel += speed * step
        speed += a * step
        a = max(a - jerk * step, -BRAKE)
    assert abs(travel - expected) <= 1e-3 * expected + 1e-5


def test_a_joint_that_never_moves_on_needs_no_way() -> None:
    """At rest or moving away, and without acceleration towards the limit."""
    assert stopping_distance(0.0, 0.0, 100.0, BRAKE) == 0.0
    assert stopping_distance(-1.0, -2.0, 100.0, BRAKE) == 0.0
    assert stopping_distance(-1.0, 1.0, 100.0, BRAKE) == 0.0  # -j ends it before v = 0
    assert stopping_distance(-1e-3, 5.0, 100.0, BRAKE) > 0.0


@pytest.mark.parametrize("seed", range(20))
def test_limits_hold_for_a_joint_that_follows_with_bounded_jerk(seed: int) -> None:
    """Greedy accelerations that change by at most j dt: the box is always within reach.

    4 s against both limits, integrated semi-implicitly as the simulator does.
    """
    rng = np.random.default_rng(seed)
    jerk = float(rng.uniform(30.0, 3000.0))
    top, speed = float(rng.uniform(0.3, 2.0)), float(rng.uniform(0.5, 3.0))
    q, v, a, wanted, reached = 0.0, 0.0, 0.0, 1.0, 0.0
    for _ in range(4000):
        if rng.random() < 0.01:
            wanted = float(rng.choice([-1.0, 1.0]))
        upper = min(
            velocity_bound(max(speed - v, 0.0), jerk, DT),
            position_bound(top - q, v, jerk, BRAKE, DT, np.inf),
        )
        lower = -min(
            velocity_bound(max(speed + v, 0.0), jerk, DT),
            position_bound(top + q, -v, jerk, BRAKE, DT, np.inf),
        )
        low, high = a - jerk * DT, a + jerk * DT
        tolerance = 1e-3 + 0.02 * jerk * DT  # of the halving, and of steps instead of a ramp
        assert lower <= high + tolerance
        assert upper >= low - tolerance
        a = float(np.clip(np.clip(100.0 * wanted, low, high), lower, upper))
        v += a * DT
        q += v * DT
        reached = max(reached, abs(q) / top, abs(v) / speed)
        assert abs(v) <= speed * (1.0 + 1e-6)
        assert abs(q) <= top + 1e-5
    assert reached > 0.9


@pytest.mark.parametrize("seed", range(5))
def test_a_bound_falls_with_less_room_and_more_speed_and_never_forbids_braking(seed: int) -> None:
    """Monotone; at least the deceleration that brakes to a stop; at most the cap."""
    rng = np.random.default_rng(seed)
    for _ in range(200):
        jerk, v = float(rng.uniform(10.0, 1e4)), float(rng.uniform(-3.0, 3.0))
        room, cap = float(rng.uniform(-0.1, 1.0)), float(rng.uniform(-BRAKE, 100.0))
        bound = position_bound(room, v, jerk, BRAKE, DT, cap)
        assert bound <= cap
        assert bound >= min(cap, -BRAKE)
        if room > 0.0:
            nearer = position_bound(0.5 * room, v, jerk, BRAKE, DT, cap)
            faster = position_bound(room, v + 0.1, jerk, BRAKE, DT, cap)
            assert nearer <= bound + 1e-3 or v > 0.0 > bound  # beyond help both only brake
            assert faster <= bound + 1e-3 or v > -0.1
    assert position_bound(np.inf, 1.0, 100.0, BRAKE, DT, 7.0) == 7.0


def test_with_unbounded_jerk_the_velocity_bound_is_one_period() -> None:
    """j to infinity: margin over 1.5 dt, one period and the step of the next."""
    assert abs(velocity_bound(0.1, 1e12, DT) - 0.1 / (1.5 * DT)) < 0.1
    assert velocity_bound(0.0, 50.0, DT) == 0.0

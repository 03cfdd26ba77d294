"""Whether a robot is at rest at the end of a phase, on signals of known speed."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.types import Array
from ghc_sim_bridge.analysis.rest import (
    REST_SPEED,
    PhaseRest,
    moving_coordinates,
    rest_line,
    rest_of_phase,
    rest_summary,
    rest_window,
)
from ghc_sim_bridge.logs.full_rate_log import FullRateLog

DT = 1e-3
TIME: Array = np.arange(10_000, dtype=np.float64) * DT
COARSE: Array = TIME[::10]
CONSTANT: tuple[Array, Array] = (COARSE, np.full((len(COARSE), 3), 0.3))


def moving_log(velocity: Array, base: Array | None) -> FullRateLog:
    """A log of joints and perhaps a base with these velocities; the rest is zero."""
    rows, joints = velocity.shape
    zero = np.zeros_like(velocity)
    return FullRateLog(
        time=TIME,
        q=zero,
        v=velocity,
        acceleration=zero,
        torque=zero,
        commanded=zero,
        source=np.zeros(rows, np.uint8),
        epoch=np.zeros(rows, np.uint32),
        cycle_time=np.zeros(rows),
        wrenches={},
        joint_names=tuple(f"joint_{k}" for k in range(joints)),
        control_dt=DT,
        base_pose=None if base is None else np.zeros((rows, 7)),
        base_velocity=base,
    )


def test_the_window_is_at_most_half_of_the_hold() -> None:
    assert [rest_window(hold) for hold in (0.0, 1.0, 6.0, 8.0)] == [0.0, 0.5, 3.0, 3.0]


def test_the_speed_is_the_mean_of_the_fastest_coordinate_within_the_window() -> None:
    velocity = np.zeros((len(TIME), 3))
    velocity[TIME < 4.9] = 5.0  # over before the window
    velocity[TIME >= 8.0 - 1e-9] = 7.0  # of the next phase
    inside = (TIME > 5.0 - 1e-9) & (TIME < 8.0 - 1e-9)
    velocity[inside, 1] = 0.02 * np.sign(np.sin(40.0 * TIME[inside]))
    velocity[inside, 2] = 0.01
    rest = rest_of_phase(TIME, velocity, [CONSTANT], 8.0, 3.0)
    assert rest.speed == pytest.approx(0.02)
    assert rest.still_moves


def test_the_mirrored_motion_has_the_same_speed() -> None:
    velocity = np.random.default_rng(4).normal(size=(len(TIME), 5))
    one, other = (
        rest_of_phase(TIME, sign * velocity, [CONSTANT], 10.0, 3.0).speed for sign in (1.0, -1.0)
    )
    assert one == other > 0.0


def test_a_robot_is_at_rest_up_to_the_threshold() -> None:
    for factor, moves in ((0.99, False), (1.01, True)):
        velocity = np.full((len(TIME), 1), factor * REST_SPEED)
        assert rest_of_phase(TIME, velocity, [CONSTANT], 10.0, 3.0).still_moves is moves


def test_a_robot_that_follows_a_moving_reference_is_meant_to_move() -> None:
    velocity = np.full((len(TIME), 2), 0.5)
    moving = (COARSE, np.column_stack([np.sin(COARSE), 0.0 * COARSE]))
    rest = rest_of_phase(TIME, velocity, [CONSTANT, moving], 10.0, 3.0)
    assert rest.speed == pytest.approx(0.5)
    assert not rest.references_rest and not rest.still_moves
    # One that moved before the window and rests within it counts as constant.
    rested = (COARSE, np.where(COARSE < 6.5, COARSE, 6.5)[:, None])
    assert rest_of_phase(TIME, velocity, [rested], 10.0, 3.0).still_moves


def test_a_base_that_floats_is_watched_as_well() -> None:
    log = moving_log(np.zeros((len(TIME), 4)), base=None)
    assert moving_coordinates(log).shape == (len(TIME), 4)
    for row in range(6):
        base = np.zeros((len(TIME), 6))
        base[:, row] = -0.02
        log = moving_log(np.zeros((len(TIME), 4)), base)
        rest = rest_of_phase(TIME, moving_coordinates(log), [CONSTANT], 10.0, 3.0)
        assert rest.speed == pytest.approx(0.02) and rest.still_moves


def test_no_hold_is_no_window_and_no_motion() -> None:
    rest = rest_of_phase(TIME, np.full((len(TIME), 2), 0.5), [CONSTANT], 8.0, rest_window(0.0))
    assert rest.speed == 0.0 and not rest.still_moves


def test_the_line_names_phases_speeds_window_and_threshold() -> None:
    phases = [PhaseRest(speed, 3.0, True) for speed in (1e-5, 0.012, 0.0, 0.02)]
    summary = {"rest": rest_summary(phases)}
    assert summary["rest"]["moving_phases"] == [2, 4]
    assert rest_line(summary) == (
        "joints still move at the end of phases 2, 4: mean |v| of the fastest one over the last "
        "3 s 0.012, 0.02 rad/s (more than 0.001)"
    )
    assert rest_line({"rest": rest_summary(phases[:1])}) == ""
    assert "phase 1: " in rest_line({"rest": rest_summary(phases[1:2])})

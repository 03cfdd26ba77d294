"""Each constraint alone: rolling out its bound never breaks the limit; boxes are never empty."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import make_model, random_state

from ghc_controller.constraints import (
    JointPositionLimit,
    JointVelocityLimit,
    TorqueCenter,
    TorqueLimit,
    TorqueRateLimit,
)
from ghc_controller.constraints.constraint import BoxConstraint
from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array, Bounds, RobotState

DT = 1e-3  # [s] control period
BRAKE = 5.0  # [rad/s^2]


def _bounds(
    constraint: BoxConstraint, model: RobotModel, q: Array, v: Array, torque: Array | None = None
) -> Bounds:
    dynamics = model.update(q, v)
    return constraint.bounds(model, dynamics, RobotState(0.0, q, v), torque, DT)


def _position_limit(model: RobotModel) -> JointPositionLimit:
    return JointPositionLimit(model.position_lower, model.position_upper, BRAKE)


@pytest.mark.parametrize("integrator", ["exact", "semi-implicit"])
@pytest.mark.parametrize("seed", range(5))
def test_position_limit_holds_whatever_is_wanted_inside_the_box(
    seed: int, integrator: str
) -> None:
    """Two seconds of random, mostly greedy accelerations from the box: q stays inside."""
    rng = np.random.default_rng(seed)
    model = make_model("kuka_lwr")
    limit = _position_limit(model)
    q = rng.uniform(0.9, 1.0, 7) * rng.choice([-1.0, 1.0], 7) * model.position_upper
    v = np.zeros(7)
    for _ in range(2000):
        box = _bounds(limit, model, q, v)
        assert (box.lower <= box.upper).all()
        wanted = rng.choice([-np.inf, 0.0, np.inf], 7, p=[0.35, 0.1, 0.55])
        x = np.clip(np.clip(wanted, -60.0, 60.0), box.lower, box.upper)
        # Nothing but the box may ask for more than braking.
        share = 0.5 if integrator == "exact" else 1.0
        q, v = q + v * DT + share * x * DT**2, v + x * DT
        assert (q <= model.position_upper + 1e-5).all()
        assert (q >= model.position_lower - 1e-5).all()


def test_braking_from_a_viable_state_never_needs_more_than_the_stated_brake() -> None:
    """Running at the limit as fast as allowed, the box never asks below -a_brake, to rounding."""
    model = make_model("kuka_lwr")
    limit = _position_limit(model)
    q, v = 0.5 * model.position_upper, np.zeros(7)
    for _ in range(3000):
        box = _bounds(limit, model, q, v)
        x = np.minimum(box.upper, 20.0)
        assert (x >= -BRAKE * (1.0 + 1e-9)).all()
        q, v = q + v * DT + 0.5 * x * DT**2, v + x * DT
        viable = np.sqrt(2.0 * BRAKE * np.maximum(model.position_upper - q, 0.0))
        assert (v <= viable + 1e-4).all()
    assert np.allclose(q, model.position_upper, atol=1e-4)
    assert np.allclose(v, 0.0, atol=1e-2)


@pytest.mark.parametrize("seed", range(20))
def test_position_box_is_never_empty_and_contains_braking(seed: int) -> None:
    """Also beyond a limit and far too fast."""
    rng = np.random.default_rng(seed)
    model = make_model("kuka_lwr")
    for _ in range(50):
        q = rng.uniform(-1.2, 1.2, 7) * model.position_upper
        v = rng.normal(scale=3.0, size=7)
        box = _bounds(_position_limit(model), model, q, v)
        brake = np.clip(-v / DT, -BRAKE, BRAKE)
        assert (box.lower <= brake).all()
        assert (brake <= box.upper).all()


def test_beyond_a_limit_only_the_way_back_is_open() -> None:
    """At rest outside, the bound outwards is zero and the way back is free."""
    model = make_model("kuka_lwr")
    box = _bounds(_position_limit(model), model, model.position_upper + 0.01, np.zeros(7))
    assert (box.upper == 0.0).all()
    assert (box.lower < -BRAKE).all()


def test_a_joint_without_limits_stays_free() -> None:
    """Infinite limits give infinite bounds."""
    model = make_model("kuka_lwr")
    limit = JointPositionLimit(np.full(7, -np.inf), np.full(7, np.inf), BRAKE)
    box = _bounds(limit, model, np.zeros(7), np.ones(7))
    assert (box.lower == -np.inf).all()
    assert (box.upper == np.inf).all()


@pytest.mark.parametrize("horizon", [1e-4, 1e-3, 1e-2, 5e-2])
def test_velocity_limit_holds_for_every_horizon(horizon: float) -> None:
    """Random greedy accelerations: |v| <= limit; a horizon below dt acts as dt."""
    rng = np.random.default_rng(0)
    model = make_model("kuka_lwr")
    limit = JointVelocityLimit(1.2, 7, horizon)
    q, v, wanted = np.zeros(7), np.zeros(7), np.full(7, 1e4)
    for _ in range(1000):
        box = _bounds(limit, model, q, v)
        v = v + DT * np.clip(wanted, box.lower, box.upper)
        assert (np.abs(v) <= 1.2 + 1e-12).all()
        wanted = np.where(rng.random(7) < 0.003, -wanted, wanted)
    assert np.abs(v).max() > 1.0


def test_too_fast_a_joint_is_braked_over_the_horizon() -> None:
    """Above the limit the box lies on the braking side."""
    model = make_model("kuka_lwr")
    box = _bounds(JointVelocityLimit(1.2, 7, 0.02), model, np.zeros(7), np.full(7, 1.5))
    assert np.allclose(box.upper, -0.3 / 0.02)
    assert (box.lower < box.upper).all()


def test_acceleration_limits_leave_a_floating_base_free() -> None:
    """Six infinite entries, then the joints."""
    rng = np.random.default_rng(1)
    model, state = make_model("humanoid"), random_state("humanoid", rng)
    speed = JointVelocityLimit(2.0, model.na, 0.02)
    place = JointPositionLimit(np.full(model.na, -3.0), np.full(model.na, 3.0))
    for constraint in (speed, place):
        box = _bounds(constraint, model, state.q, state.v)
        assert box.lower.shape == (model.nv,)
        assert np.isinf(box.lower[:6]).all()
        assert np.isfinite(box.lower[6:]).all()


def test_torque_limit_around_zero_and_around_gravity() -> None:
    """Per actuated joint, also behind a floating base."""
    for robot in ("kuka_lwr", "humanoid"):
        model, state = make_model(robot), random_state(robot, np.random.default_rng(2))
        box = _bounds(TorqueLimit(1.5, model.na), model, state.q, state.v)
        assert np.array_equal(box.upper, np.full(model.na, 1.5))
        around = TorqueLimit(1.5, model.na, TorqueCenter.GRAVITY)
        box = _bounds(around, model, state.q, state.v)
        gravity = model.gravity()[-model.na :]
        assert np.allclose(box.lower, gravity - 1.5, atol=1e-12)
        assert np.allclose(box.upper, gravity + 1.5, atol=1e-12)


def test_torque_rate_is_measured_from_the_applied_torque() -> None:
    """previous -+ rate dt; nothing before the first torque."""
    model = make_model("kuka_lwr")
    limit = TorqueRateLimit(1000.0, 7)
    applied = np.arange(7.0)
    box = _bounds(limit, model, np.zeros(7), np.zeros(7), applied)
    assert np.allclose(box.lower, applied - 1.0)
    assert np.allclose(box.upper, applied + 1.0)
    free = _bounds(limit, model, np.zeros(7), np.zeros(7))
    assert np.isinf(free.lower).all()
    assert np.isinf(free.upper).all()


def test_limits_must_be_positive_and_fit_the_joints() -> None:
    """Messages name the constraint."""
    with pytest.raises(InvalidValue, match=r"velocity_limit: \[0.0, 0.0\] given, positive"):
        JointVelocityLimit(0.0, 2, 0.02)
    with pytest.raises(WrongSize, match=r"torque_limit: size \(3,\) given, \(7,\) expected"):
        TorqueLimit(np.ones(3), 7)
    with pytest.raises(InvalidValue, match="position_limit, brake acceleration: "):
        JointPositionLimit(np.zeros(1), np.ones(1), brake_acceleration=-1.0)

"""The jerk that limits plan with: within the torque rate for any signs, from the model."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from model_states import make_model, moved, random_state

from ghc_controller.constraints import (
    ConstraintSet,
    JointPositionLimit,
    JointVelocityLimit,
    Tick,
    TorqueRateLimit,
)
from ghc_controller.constraints.planned_jerk import PlannedJerk
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array, Dynamics, RobotState

DT = 1e-3  # [s]
RATE = 1000.0  # [Nm/s]


def _dynamics(mass: Array, bias: Array | None = None) -> Dynamics:
    return Dynamics(mass, np.zeros(len(mass)) if bias is None else bias)


def _random_mass(rng: np.random.Generator, size: int) -> Array:
    factor = rng.normal(size=(size, size))
    scale = 10.0 ** rng.uniform(-1.0, 1.0, size)
    return np.ascontiguousarray((factor @ factor.T + 0.1 * np.eye(size)) * np.outer(scale, scale))


def _state(v: Array, time: float = 0.0) -> RobotState:
    return RobotState(time, np.zeros(len(v)), v)


@pytest.mark.parametrize("seed", range(10))
def test_all_joints_unwind_at_once_within_the_rate_whatever_their_directions(seed: int) -> None:
    """|M (signs * j)| <= r for every combination of signs, and one row uses all of it."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(2, 8))
    mass, rate = _random_mass(rng, size), rng.uniform(100.0, 1000.0, size)
    jerk = PlannedJerk(rate, size).update(_dynamics(mass), _state(np.zeros(size)), None, DT)
    torque = np.array([np.abs(mass @ (np.array(s) * jerk)) for s in product((-1, 1), repeat=size)])
    assert (jerk > 0.0).all()
    assert (torque <= rate * (1.0 + 1e-9)).all()
    assert abs((torque / rate).max() - 1.0) < 1e-9


def test_joints_that_do_not_couple_use_the_whole_rate() -> None:
    """A diagonal inertia: j = r / M_ii, share 1."""
    plan = PlannedJerk(RATE, 3)
    mass = np.diag([0.1, 1.0, 4.0])
    jerk = plan.update(_dynamics(mass), _state(np.zeros(3)), None, DT)
    assert np.allclose(jerk, RATE / np.diag(mass))
    assert abs(plan.share - 1.0) < 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_the_measured_drift_is_the_torque_change_at_constant_acceleration(seed: int) -> None:
    """KUKA, two states 1 ms apart, by inverse dynamics; it fades, and a reset forgets it."""
    rng = np.random.default_rng(seed)
    model = make_model("kuka_lwr")
    first = random_state("kuka_lwr", rng)
    x = rng.uniform(-5.0, 5.0, 7)  # [rad/s^2]
    v = first.v + DT * x
    second = RobotState(DT, moved("kuka_lwr", first.q, DT * v), v)
    plan, terms = PlannedJerk(RATE, 7), []
    for state in (first, second):
        dynamics = model.update(state.q, state.v)
        terms.append(dynamics.mass_matrix @ x + dynamics.bias)
        plan.update(dynamics, state, None, DT)
    drift = np.abs(terms[1] - terms[0]) / DT
    assert np.allclose(plan.drift, drift, rtol=1e-6, atol=1e-6)
    late = RobotState(1.0, second.q, second.v)  # too late to be compared
    plan.update(dynamics, late, None, DT)
    assert np.allclose(plan.drift, drift * np.exp(-DT / 0.05))
    plan.reset()
    assert (plan.drift == 0.0).all()


def test_drift_takes_away_from_the_rate_but_never_all_of_it() -> None:
    """A tenth of the rate is kept, also where numbers are not finite for once."""
    mass, still = np.eye(2), np.zeros(2)
    for bias, expected in ((0.4, 600.0), (0.95, 100.0), (5.0, 100.0), (np.nan, 1000.0)):
        plan = PlannedJerk(RATE, 2)
        plan.update(_dynamics(mass), _state(still), None, DT)
        jerk = plan.update(_dynamics(mass, np.array([bias, 0.0])), _state(still, DT), None, DT)
        assert np.allclose(jerk, expected), bias


@pytest.mark.parametrize("seed", range(3))
def test_a_free_base_keeps_its_momentum(seed: int) -> None:
    """Without contacts G M has no entry on the base: nothing carries it."""
    rng = np.random.default_rng(seed)
    model, state = make_model("humanoid"), random_state("humanoid", rng)
    mass = model.update(state.q, state.v).mass_matrix
    plan = PlannedJerk(RATE, model.na)
    plan.update(model.dynamics, state, None, DT)
    carried = plan.carried
    assert np.abs(carried @ mass[:, :6]).max() < 1e-9 * np.abs(mass).max()


@pytest.mark.parametrize("seed", range(3))
def test_a_base_that_one_foot_holds_follows_its_leg_alone(seed: int) -> None:
    """J (B x_j, x_j) = 0 for a frame with six rows; T is then the inertia seen from that frame."""
    rng = np.random.default_rng(seed)
    model, state = make_model("humanoid"), random_state("humanoid", rng)
    frame = model.frame_id(model.frame_names[-1])
    mass = model.update(state.q, state.v).mass_matrix
    jacobian = np.ascontiguousarray(model.frame_jacobian(frame))
    plan = PlannedJerk(RATE, model.na)
    plan.update(model.dynamics, state, jacobian, DT)
    carried = plan.carried
    assert np.abs(jacobian @ carried.T).max() < 2e-3 * np.abs(jacobian).max()
    exact = np.hstack([-np.linalg.solve(jacobian[:, :6], jacobian[:, 6:]).T, np.eye(model.na)])
    inertia = exact @ mass @ exact.T
    assert np.allclose(carried @ mass @ carried.T, inertia, rtol=1e-2, atol=1e-2 * inertia.max())


def _boxes(model: RobotModel, planned: PlannedJerk | None, torque: Array | None) -> Array:
    rng = np.random.default_rng(1)
    constraints = ConstraintSet(
        [
            TorqueRateLimit(RATE, model.na),
            JointPositionLimit(model.position_lower, model.position_upper),
            JointVelocityLimit(1.2, model.na, 0.05),
        ],
        model,
        planned,
    )
    found = []
    for scale in (0.5, 0.9, 0.99, 1.01):
        q, v = scale * model.position_upper, rng.uniform(-1.2, 1.2, model.na)
        dynamics = model.update(q, v)
        box = constraints.update(model, dynamics, RobotState(0.0, q, v), torque, DT).acceleration
        found.append([box.bounds.lower.copy(), box.bounds.upper.copy()])
    return np.array(found)


def test_without_a_rate_limit_or_a_torque_before_no_bound_changes() -> None:
    """With both, boxes are narrower, never wider but for what overshoot makes empty."""
    model = make_model("kuka_lwr")
    plain = _boxes(model, None, np.zeros(7))
    assert (_boxes(model, PlannedJerk(RATE, 7), None) == plain).all()
    planned = _boxes(model, PlannedJerk(RATE, 7), np.zeros(7))
    inside = slice(0, 3)  # states within the limits
    assert (planned[inside, 0] >= plain[inside, 0] - 1e-9).all()
    assert (planned[inside, 1] <= plain[inside, 1] + 1e-9).all()
    assert (planned != plain).any()


@pytest.mark.parametrize("seed", range(5))
def test_a_position_box_is_never_empty_however_close_the_limits(seed: int) -> None:
    """Ranges of 2e-4 to 1 rad, jerks of 1 to 1e4 rad/s^3: the limit ahead counts as if alone."""
    rng = np.random.default_rng(seed)
    model = make_model("kuka_lwr")
    torque = np.zeros(7)
    for _ in range(200):
        state = random_state("kuka_lwr", rng)
        ahead, behind = 10.0 ** rng.uniform(-4.0, 0.0, (2, 7)) * rng.uniform(-0.05, 1.0, (2, 7))
        v = rng.choice([-1.0, 1.0], 7) * 10.0 ** rng.uniform(-3.0, 0.7, 7)
        dynamics = model.update(state.q, v)
        tick = Tick(model, dynamics, state, torque, DT, 10.0 ** rng.uniform(0.0, 4.0, 7))
        up = v > 0.0
        to_upper, to_lower = np.where(up, ahead, behind), np.where(up, behind, ahead)
        brake = 10.0 ** rng.uniform(0.0, 2.0, 7)
        both, alone = np.zeros((2, 7)), np.zeros((2, 7))
        lower, upper = state.q - to_lower, state.q + to_upper
        JointPositionLimit(lower, upper, brake).write(tick, *both)
        free = np.where(up, -np.inf, lower), np.where(up, upper, np.inf)
        JointPositionLimit(*free, brake).write(tick, *alone)
        assert (both[0] <= both[1]).all()
        assert np.array_equal(np.where(up, both[1], both[0]), np.where(up, alone[1], alone[0]))


def test_a_rate_that_is_not_positive_is_rejected() -> None:
    """No rate limit means no planned jerk."""
    with pytest.raises(InvalidValue, match="torque_rate"):
        PlannedJerk(0.0, 7)

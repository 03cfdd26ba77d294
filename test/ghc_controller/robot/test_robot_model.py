"""RobotModel against finite differences and Pinocchio's own algorithms."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from model_states import ROBOTS, make_model, moved, pin_model, random_state

from ghc_controller.errors import ConfigurationError, UnknownName, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

STEP = 1e-6  # [s] of central differences: error below 1e-8 at |v| <= 1

ONE_JOINT = """<robot name="one"><link name="base"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="{kind}"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="2" effort="3"/></joint></robot>"""


def _rate(query: Callable[[Array, Array], Array], robot: str, q: Array, v: Array) -> Array:
    """d/dt of query(q, v) along dq/dt = v at dv = 0."""
    after = query(moved(robot, q, STEP * v), v).copy()
    return (after - query(moved(robot, q, -STEP * v), v)) / (2.0 * STEP)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("seed", range(3))
def test_jacobian_velocity_and_drift_match_finite_differences(robot: str, seed: int) -> None:
    """J v is the velocity of every frame and the drift its derivative at constant v."""
    model, state = make_model(robot), random_state(robot, np.random.default_rng(seed))
    frames = {name: model.frame_id(name) for name in model.frame_names}

    def velocity(frame: int) -> Callable[[Array, Array], Array]:
        def query(q: Array, v: Array) -> Array:
            model.update(q, v)
            return model.frame_jacobian(frame) @ v

        return query

    def position(frame: int) -> Callable[[Array, Array], Array]:
        def query(q: Array, v: Array) -> Array:
            model.update(q, v)
            return model.frame_position(frame)

        return query

    for frame in frames.values():
        model.update(state.q, state.v)
        term = model.frame(frame)
        expected_velocity, expected_drift = term.velocity.copy(), term.drift.copy()
        assert np.allclose(term.jacobian @ state.v, expected_velocity, atol=1e-12)
        measured = _rate(position(frame), robot, state.q, state.v)
        assert np.allclose(measured, expected_velocity[:3], atol=1e-7)
        measured = _rate(velocity(frame), robot, state.q, state.v)
        assert np.allclose(measured, expected_drift, atol=1e-6)


@pytest.mark.parametrize("robot", ROBOTS)
def test_angular_rows_turn_the_frame(robot: str) -> None:
    """dR/dt = [w] R with w the angular part of J v, in world axes."""
    model, state = make_model(robot), random_state(robot, np.random.default_rng(3))
    frame = model.frame_id(model.frame_names[-1])

    def rotation(q: Array, v: Array) -> Array:
        model.update(q, v)
        return model.frame_rotation(frame)

    rate = _rate(rotation, robot, state.q, state.v)
    model.update(state.q, state.v)
    omega = model.frame_velocity(frame)[3:]
    assert np.allclose(rate, pin.skew(omega) @ model.frame_rotation(frame), atol=1e-7)


@pytest.mark.parametrize("robot", ROBOTS)
def test_dynamics_match_inverse_dynamics(robot: str) -> None:
    """M dv + h equals the recursive Newton-Euler torque; M is symmetric to the bit."""
    rng = np.random.default_rng(4)
    model, state = make_model(robot), random_state(robot, rng)
    dynamics = model.update(state.q, state.v)
    dv = rng.normal(size=model.nv)
    plain = pin_model(robot)
    expected = pin.rnea(plain, plain.createData(), state.q, state.v, dv)
    assert np.allclose(dynamics.mass_matrix @ dv + dynamics.bias, expected, atol=1e-9)
    assert np.array_equal(dynamics.mass_matrix, dynamics.mass_matrix.T)
    assert dynamics.mass_matrix.flags.c_contiguous


@pytest.mark.parametrize("robot", ROBOTS)
def test_gravity_is_the_bias_at_rest(robot: str) -> None:
    """gravity() after an update with any v equals h(q, 0)."""
    model, state = make_model(robot), random_state(robot, np.random.default_rng(5))
    model.update(state.q, state.v)
    gravity = model.gravity().copy()
    assert np.allclose(model.update(state.q, 0.0 * state.v).bias, gravity, atol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
def test_center_of_mass_terms_match_finite_differences(robot: str) -> None:
    """Jacobian, velocity and drift of the center of mass belong together."""
    model, state = make_model(robot), random_state(robot, np.random.default_rng(6))

    def position(q: Array, v: Array) -> Array:
        model.update(q, v)
        return model.center_of_mass()

    def velocity(q: Array, v: Array) -> Array:
        model.update(q, v)
        return model.center_of_mass_jacobian() @ v

    rates = [_rate(query, robot, state.q, state.v) for query in (position, velocity)]
    model.update(state.q, state.v)
    assert np.allclose(model.center_of_mass_velocity(), rates[0], atol=1e-7)
    assert np.allclose(model.center_of_mass_jacobian() @ state.v, rates[0], atol=1e-7)
    assert np.allclose(model.center_of_mass_drift(), rates[1], atol=1e-6)


@pytest.mark.parametrize("robot", ROBOTS)
def test_other_queries_do_not_disturb_the_frames(robot: str) -> None:
    """A frame asked for after center of mass and gravity is as current as one asked before."""
    state = random_state(robot, np.random.default_rng(7))
    early, late = make_model(robot), make_model(robot)
    name = early.frame_names[-1]
    frame = early.frame_id(name)
    early.update(state.q, state.v)
    late.update(state.q, state.v)
    late.gravity()
    late.center_of_mass_drift()
    late.center_of_mass_jacobian()
    other = late.frame_id(name)
    assert np.array_equal(early.frame_jacobian(frame), late.frame_jacobian(other))
    assert np.allclose(early.frame_drift(frame), late.frame_drift(other), atol=1e-12)


def test_terms_are_views_of_the_newest_state() -> None:
    """Dynamics and frame terms stay the same arrays; the next update overwrites them."""
    rng = np.random.default_rng(8)
    model = make_model("kuka_lwr")
    frame = model.frame_id("tool")
    first, second = random_state("kuka_lwr", rng), random_state("kuka_lwr", rng)
    dynamics, position = model.update(first.q, first.v), model.frame_position(frame)
    kept = dynamics.bias.copy()
    assert model.update(second.q, second.v) is dynamics
    assert not np.allclose(dynamics.bias, kept)
    assert position is model.frame_position(frame)


def test_an_exerted_force_joins_the_bias_until_the_next_update() -> None:
    """Calls of one name replace each other, those of two names add up; update forgets them."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(9))
    free = model.update(state.q, state.v)
    jacobian = model.frame_jacobian(model.frame_id("tool"))[:3]
    force = np.array([1.0, -2.0, 3.0])
    for _ in range(2):
        model.exert("hand", jacobian, force)
    assert np.allclose(model.dynamics.bias, free.bias + jacobian.T @ force, atol=1e-12)
    model.exert("other", jacobian, force)
    assert np.allclose(model.dynamics.bias, free.bias + 2.0 * jacobian.T @ force, atol=1e-12)
    assert np.array_equal(model.update(state.q, state.v).bias, free.bias)
    assert model.dynamics.bias.tolist() == free.bias.tolist()


def test_names_and_limits_of_the_lwr() -> None:
    """Seven joints in order, the frames of the tasks, and finite limits."""
    model = make_model("kuka_lwr")
    assert model.joint_names == tuple(f"joint_{i}" for i in range(1, 8))
    assert {"elbow", "tool"} <= set(model.frame_names)
    assert not model.floating_base
    assert (model.nq, model.nv, model.na) == (7, 7, 7)
    for limit in (model.velocity_limit, model.torque_limit):
        assert limit.shape == (7,)
        assert (limit > 0.0).all()
        assert np.isfinite(limit).all()
    assert (model.position_lower < model.position_upper).all()


def test_a_floating_base_is_recognised() -> None:
    """The first six velocity coordinates are not joints."""
    model = make_model("humanoid")
    assert model.floating_base
    assert (model.nq, model.nv, model.na) == (33, 32, 26)


def test_errors_name_what_is_wrong(tmp_path: Path) -> None:
    """Unknown frame, wrong sizes, missing and unreadable files, unsupported joints."""
    model = make_model("kuka_lwr")
    with pytest.raises(UnknownName, match=r"unknown frame 'hand'; known: .*elbow.*tool"):
        model.frame_id("hand")
    with pytest.raises(UnknownName, match=r"unknown joint 'joint_8'; known: joint_1, "):
        model.joint_index("joint_8")
    with pytest.raises(WrongSize, match=r"q: size \(3,\) given, \(7,\) expected"):
        model.update(np.zeros(3), np.zeros(7))
    with pytest.raises(ConfigurationError, match=r"nowhere.urdf: robot model does not exist"):
        RobotModel.from_urdf(tmp_path / "nowhere.urdf")
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot")
    with pytest.raises(ConfigurationError, match=r"broken.urdf: not a readable URDF"):
        RobotModel.from_urdf(broken)
    wheel = tmp_path / "wheel.urdf"
    wheel.write_text(ONE_JOINT.format(kind="continuous"))
    with pytest.raises(ConfigurationError, match=r"wheel.urdf: joint 'hinge' has several"):
        RobotModel.from_urdf(wheel)


def test_a_urdf_gets_a_floating_base_on_request(tmp_path: Path) -> None:
    """The same file, with and without a free flyer in front."""
    path = tmp_path / "one.urdf"
    path.write_text(ONE_JOINT.format(kind="revolute"))
    fixed, floating = RobotModel.from_urdf(path), RobotModel.from_urdf(path, floating_base=True)
    assert (fixed.nq, fixed.nv, fixed.na) == (1, 1, 1)
    assert (floating.nq, floating.nv, floating.na) == (8, 7, 1)
    assert fixed.torque_limit == floating.torque_limit == [3.0]
    assert fixed.joint_names == floating.joint_names == ("hinge",)

"""Reference trajectories: interpolation, holding, validation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from model_states import make_model

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.numerics.rotation import quaternion_conjugate, quaternion_product, rotation_log
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.tasks import ReferenceSpace
from ghc_controller.tasks.frame import FramePoseTask
from ghc_controller.types import Array

SPACES = tuple(ReferenceSpace)
SIZES = {ReferenceSpace.VECTOR: 4, ReferenceSpace.ORIENTATION: 3, ReferenceSpace.POSE: 6}


def _positions(rng: np.random.Generator, space: ReferenceSpace, count: int) -> Array:
    vector = rng.normal(size=(count, 4 if space is ReferenceSpace.VECTOR else 3))
    quaternion = np.array([0.0, 0.0, 0.0, 1.0]) + 0.3 * rng.normal(size=(count, 4))
    quaternion /= np.linalg.norm(quaternion, axis=1)[:, None]
    parts = {
        ReferenceSpace.VECTOR: vector,
        ReferenceSpace.ORIENTATION: quaternion,
        ReferenceSpace.POSE: np.hstack([vector, quaternion]),
    }
    return parts[space]


def _trajectory(space: ReferenceSpace, derivatives: int, seed: int = 0) -> ReferenceTrajectory:
    """Five random points; derivatives = 0 linear, 1 cubic, 2 quintic."""
    rng = np.random.default_rng(seed)
    fields: dict[str, Any] = {}
    for name in ("velocity", "acceleration")[:derivatives]:
        fields[name] = rng.normal(size=(5, SIZES[space]))
    times = np.array([0.0, 0.5, 0.8, 2.0, 3.0])
    return ReferenceTrajectory(
        "hand", space, SIZES[space], times, _positions(rng, space, 5), start_time=10.0, **fields
    )


def _distance(space: ReferenceSpace, a: Array, b: Array) -> Array:
    """b - a per row; the rotation from a to b in world axes for a quaternion."""
    if space is ReferenceSpace.VECTOR:
        return b - a
    turn = rotation_log(quaternion_product(b[-4:], quaternion_conjugate(a[-4:])))
    return np.concatenate([(b - a)[:-4], turn])


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("derivatives", [0, 1, 2])
def test_points_are_met_with_the_derivatives_given(
    space: ReferenceSpace, derivatives: int
) -> None:
    """Position, velocity and acceleration at every point, from both sides."""
    trajectory = _trajectory(space, derivatives)
    for index, time in enumerate(trajectory.times):
        for side in (-1e-9, 0.0, 1e-9):
            at = trajectory.target(10.0 + np.clip(time + side, 0.0, 3.0))
            gap = _distance(space, trajectory.position[index], at.position)
            assert np.allclose(gap, 0.0, atol=1e-7)
            if trajectory.velocity is not None:
                assert np.allclose(at.velocity, trajectory.velocity[index], atol=1e-6)
            if trajectory.acceleration is not None:
                assert np.allclose(at.acceleration, trajectory.acceleration[index], atol=1e-5)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("derivatives", [0, 1, 2])
def test_velocity_and_acceleration_are_derivatives_of_the_position(
    space: ReferenceSpace, derivatives: int
) -> None:
    """Central differences inside the segments; angular ones in world axes."""
    trajectory, step = _trajectory(space, derivatives, seed=1), 1e-5
    for time in 10.0 + np.array([0.2, 0.65, 1.1, 1.7, 2.9]):
        before, at, after = (trajectory.target(time + s) for s in (-step, 0.0, step))
        moved = _distance(space, before.position, after.position) / (2.0 * step)
        assert np.allclose(moved, at.velocity, atol=1e-6)
        gained = (after.velocity - before.velocity) / (2.0 * step)
        assert np.allclose(gained, at.acceleration, atol=1e-5)


@pytest.mark.parametrize("space", SPACES)
def test_without_velocities_the_way_is_straight(space: ReferenceSpace) -> None:
    """Linear or slerp: half the time is half the way, at constant speed."""
    trajectory = _trajectory(space, 0)
    start, end = trajectory.position[2], trajectory.position[3]
    middle = trajectory.target(10.0 + 1.4)
    way = _distance(space, start, end)
    assert np.allclose(_distance(space, start, middle.position), 0.5 * way, atol=1e-12)
    assert np.allclose(middle.velocity, way / 1.2, atol=1e-12)
    assert np.allclose(middle.acceleration, 0.0, atol=1e-12)


def test_a_quintic_reproduces_a_polynomial_of_degree_five() -> None:
    """Interpolation is exact where the curve is in its space."""
    curve = np.polynomial.Polynomial([0.1, -0.4, 0.3, 0.7, -0.2, 0.05])
    times = np.array([0.0, 1.0, 1.5])
    trajectory = ReferenceTrajectory(
        "hand",
        ReferenceSpace.VECTOR,
        1,
        times,
        *(
            curve.deriv(order)(times)[:, None] if order else curve(times)[:, None]
            for order in range(3)
        ),
    )
    for time in np.linspace(0.0, 1.5, 31):
        target = trajectory.target(time)
        assert np.isclose(target.position[0], curve(time), atol=1e-12)
        assert np.isclose(target.velocity[0], curve.deriv(1)(time), atol=1e-11)
        assert np.isclose(target.acceleration[0], curve.deriv(2)(time), atol=1e-10)


@pytest.mark.parametrize("space", SPACES)
def test_ends_are_held_at_rest(space: ReferenceSpace) -> None:
    """Before the first and after the last point nothing moves, and nothing is allocated."""
    trajectory = _trajectory(space, 2)
    for time, point in ((9.0, 0), (13.5, -1)):
        target = trajectory.target(time)
        assert np.array_equal(target.position, trajectory.position[point])
        assert not target.velocity.any()
        assert not target.acceleration.any()
        assert trajectory.target(time) is target
    assert trajectory.end_time == 13.0


def test_one_point_is_a_static_target() -> None:
    """A point, with its wrench, indefinitely."""
    trajectory = ReferenceTrajectory(
        "hand",
        ReferenceSpace.VECTOR,
        2,
        np.zeros(1),
        np.array([[1.0, 2.0]]),
        wrench=np.array([[0.0, -5.0]]),
    )
    for time in (-1.0, 0.0, 7.0):
        assert trajectory.target(time).position.tolist() == [1.0, 2.0]
        wrench = trajectory.target(time).wrench
        assert wrench is not None
        assert wrench.tolist() == [0.0, -5.0]


def test_wrenches_are_linear_between_points_and_held_after() -> None:
    """A force ramp."""
    trajectory = ReferenceTrajectory(
        "hand",
        ReferenceSpace.VECTOR,
        1,
        np.array([0.0, 2.0]),
        np.zeros((2, 1)),
        wrench=np.array([[0.0], [-10.0]]),
    )
    forces = [trajectory.target(time).wrench for time in (0.0, 0.5, 2.0, 3.0)]
    assert [None if force is None else float(force[0]) for force in forces] == [0, -2.5, -10, -10]


def test_a_trajectory_takes_its_sizes_from_the_task() -> None:
    """for_task and static, on a pose."""
    model = make_model("kuka_lwr")
    task = FramePoseTask("hand", model, "tool", 30.0, 20.0)
    target = task.default_target(model)
    trajectory = ReferenceTrajectory.static(task, target, start_time=1.0)
    assert trajectory.space is ReferenceSpace.POSE
    assert np.allclose(trajectory.target(2.0).position, target.position)
    with pytest.raises(WrongSize, match=r"task 'hand', position: size \(1, 6\) given, \(1, 7\)"):
        ReferenceTrajectory.for_task(task, np.zeros(1), np.zeros((1, 6)))


def test_the_trajectory_keeps_its_own_copy() -> None:
    """Changing the arrays afterwards changes nothing."""
    position = np.zeros((1, 2))
    trajectory = ReferenceTrajectory("hand", ReferenceSpace.VECTOR, 2, np.zeros(1), position)
    position += 1.0
    assert not trajectory.target(0.0).position.any()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"times": [0.0, 1.0, 1.0]}, "'hand', times: 1 s, then 1 s given, increasing times"),
        ({"times": []}, r"'hand', times: size \(0,\) given, \(p,\) with p >= 1 expected"),
        ({"times": [0.0, np.inf, 2.0]}, r"'hand', times: inf given at \[1\], finite numbers"),
        ({"velocity": np.zeros((3, 3))}, r"'hand', velocity: size \(3, 3\) given, \(3, 2\) exp"),
        ({"wrench": np.zeros((2, 2))}, r"'hand', wrench: size \(2, 2\) given, \(3, 2\) expected"),
        ({"acceleration": np.zeros((3, 2))}, "'hand', acceleration: given without velocity"),
        ({"position": np.full((3, 2), np.nan)}, r"'hand', position: nan given at \[0, 0\]"),
        ({"start_time": np.nan}, "'hand', start_time: nan given, a finite number expected"),
    ],
)
def test_errors_name_task_field_given_and_expected(changes: dict[str, Any], message: str) -> None:
    """Each fault alone, in an otherwise good trajectory."""
    fields: dict[str, Any] = {"times": [0.0, 1.0, 2.0], "position": np.zeros((3, 2))} | changes
    with pytest.raises((WrongSize, InvalidValue), match=message):
        ReferenceTrajectory("hand", ReferenceSpace.VECTOR, 2, **fields)


def test_a_quaternion_must_have_unit_length() -> None:
    """Nearly unit ones are normalized, others rejected with their length."""
    points = np.array([[0.0, 0.0, 0.0, 1.0005]])
    space = ReferenceSpace.ORIENTATION
    trajectory = ReferenceTrajectory("hand", space, 3, np.zeros(1), points)
    assert trajectory.target(0.0).position[3] == 1.0
    with pytest.raises(InvalidValue, match="'hand', position: quaternion of length 2 given at"):
        ReferenceTrajectory("hand", space, 3, np.zeros(1), 2.0 * np.eye(4)[:1])

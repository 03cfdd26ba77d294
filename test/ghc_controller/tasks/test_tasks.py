"""Every kind of task: error, rows, signs of the local controller, messages."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from model_states import ROBOTS, make_model, moved, random_state, rows_of

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import quaternion_product, rotation_exp
from ghc_controller.tasks import TASKS, Task
from ghc_controller.tasks.center_of_mass import CenterOfMassTask
from ghc_controller.tasks.frame import FrameOrientationTask, FramePoseTask, FramePositionTask
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.tasks.relative_frame import (
    RelativeFrameTask,
    RelativeOrientationTask,
    RelativePoseTask,
    RelativePositionTask,
)
from ghc_controller.types import Array, RobotState, TaskTarget

RELATIVE: dict[str, type[RelativeFrameTask]] = {
    "relative_position": RelativePositionTask,
    "relative_orientation": RelativeOrientationTask,
    "relative_pose": RelativePoseTask,
}
KINDS = (
    "frame_position",
    "axes",
    "frame_orientation",
    "frame_pose",
    "posture",
    "center_of_mass",
    *RELATIVE,
)
STIFFNESS, DAMPING = 30.0, 20.0  # [1/s^2], [1/s]


def _task(kind: str, model: RobotModel) -> Task:
    frame, gains = model.frame_names[-1], (STIFFNESS, DAMPING)
    if kind in RELATIVE:
        return RELATIVE[kind](kind, model, frame, model.frame_names[2], *gains)
    if kind == "axes":
        return FramePositionTask(kind, model, frame, *gains, axes=("z", "x"))
    if kind == "posture":
        return PostureTask(kind, model, *gains)
    if kind == "center_of_mass":
        return CenterOfMassTask(kind, model, *gains)
    kinds = {
        "frame_position": FramePositionTask,
        "frame_orientation": FrameOrientationTask,
        "frame_pose": FramePoseTask,
    }
    return kinds[kind](kind, model, frame, *gains)


def _shifted(task: Task, position: Array, step: Array) -> Array:
    """Target position whose error is `step` (m,) when the robot is at `position`."""
    if len(position) == task.size:
        return position + step
    turned = quaternion_product(rotation_exp(step[-3:]), position[-4:])
    return np.concatenate([position[:-4] + step[:-3], turned])


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
def test_error_is_zero_at_the_target_and_known_beside_it(kind: str, robot: str) -> None:
    """The default target is where the robot is; a shifted target gives the shift as error."""
    rng = np.random.default_rng(0)
    model, state = make_model(robot), random_state(robot, rng)
    task = _task(kind, model)
    model.update(state.q, state.v)
    target = task.default_target(model)
    assert np.allclose(rows_of(task, model, state, target).error, 0.0, atol=1e-9)
    step = rng.uniform(-0.4, 0.4, task.size)
    beside = task.static_target(_shifted(task, task.current(model), step))
    assert np.allclose(rows_of(task, model, state, beside).error, step, atol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
def test_rows_are_the_local_controller_minus_drift(kind: str, robot: str) -> None:
    """target = acceleration + kp e + kd (velocity* - J v) - J' v; J has one row per label."""
    rng = np.random.default_rng(1)
    model, state = make_model(robot), random_state(robot, rng)
    task = _task(kind, model)
    model.update(state.q, state.v)
    step, velocity, acceleration = rng.uniform(-0.4, 0.4, (3, task.size))
    target = TaskTarget(_shifted(task, task.current(model), step), velocity, acceleration)
    rows = rows_of(task, model, state, target)
    still = TaskTarget(task.current(model), rows.jacobian @ state.v, np.zeros(task.size))
    drift = -rows_of(task, model, state, still).target
    expected = (
        acceleration + STIFFNESS * step + DAMPING * (velocity - rows.jacobian @ state.v) - drift
    )
    assert rows.jacobian.shape == (task.size, model.nv)
    assert rows.jacobian.flags.c_contiguous
    assert np.allclose(rows.target, expected, atol=1e-8)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
def test_drift_is_what_is_left_of_the_acceleration_at_dv_zero(kind: str, robot: str) -> None:
    """d/dt (J v) at constant v, by finite differences of the task's own Jacobian."""
    model, state = make_model(robot), random_state(robot, np.random.default_rng(2))
    task = _task(kind, model)
    step = 1e-6  # [s]

    def velocity(time: float) -> Array:
        model.update(moved(robot, state.q, time * state.v), state.v)
        return (
            rows_of(task, model, state, task.static_target(task.current(model))).jacobian @ state.v
        )

    measured = (velocity(step) - velocity(-step)) / (2.0 * step)
    model.update(state.q, state.v)
    still = TaskTarget(task.current(model), velocity(0.0), np.zeros(task.size))
    assert np.allclose(-rows_of(task, model, state, still).target, measured, atol=1e-6)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
def test_following_the_rows_from_rest_reduces_the_error(kind: str, robot: str) -> None:
    """After a time t at rest and acceleration kp e the error is (1 - kp t^2 / 2) e."""
    rng = np.random.default_rng(3)
    model, state = make_model(robot), random_state(robot, rng)
    model.update(state.q, 0.0 * state.v)
    task = _task(kind, model)
    target = task.static_target(
        _shifted(task, task.current(model), rng.uniform(-0.1, 0.1, task.size))
    )
    before = rows_of(task, model, state, target)
    dv = np.linalg.lstsq(before.jacobian, before.target, rcond=1e-6)[0]
    reached = before.jacobian @ dv  # differs from the target where the task has too few joints
    time = 1e-3  # [s]
    model.update(moved(robot, state.q, 0.5 * time**2 * dv), 0.0 * state.v)
    after = rows_of(task, model, state, target)
    assert np.linalg.norm(after.error) < np.linalg.norm(before.error)
    if np.allclose(reached, before.target, atol=1e-6):
        expected = (1.0 - 0.5 * STIFFNESS * time**2) * before.error
        assert np.allclose(after.error, expected, atol=1e-7)


def test_orientation_error_obeys_the_stated_relation() -> None:
    """J_r(e) e' = -w for a reference at rest, with w = J v; and |e|' = -e . w / |e|."""
    rng = np.random.default_rng(4)
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", rng)
    task = _task("frame_orientation", model)
    model.update(state.q, state.v)
    target = task.static_target(_shifted(task, task.current(model), np.array([0.9, -1.2, 0.7])))
    rows = rows_of(task, model, state, target)
    omega, step = rows.jacobian @ state.v, 1e-6
    errors = []
    for time in (-step, step):
        model.update(moved("kuka_lwr", state.q, time * state.v), state.v)
        errors.append(rows_of(task, model, state, target).error)
    rate = (errors[1] - errors[0]) / (2.0 * step)
    assert np.allclose(pin.Jexp3(rows.error) @ rate, -omega, atol=1e-6)
    shrink = (np.linalg.norm(errors[1]) - np.linalg.norm(errors[0])) / (2.0 * step)
    assert np.isclose(shrink, -rows.error @ omega / np.linalg.norm(rows.error), atol=1e-6)


def test_posture_takes_joints_by_name() -> None:
    """Rows follow the given joints, and values given in another order are sorted."""
    model, state = make_model("humanoid"), random_state("humanoid", np.random.default_rng(6))
    joints = (model.joint_names[4], model.joint_names[0])
    task = PostureTask("legs", model, STIFFNESS, DAMPING, joints=joints)
    model.update(state.q, state.v)
    rows = rows_of(task, model, state, task.static_target(np.zeros(2)))
    assert np.array_equal(rows.error, -state.q[[7 + 4, 7]])
    assert np.array_equal(rows.jacobian @ state.v, state.v[[6 + 4, 6]])
    assert task.ordered(joints[::-1], np.array([[1.0, 2.0]])).tolist() == [[2.0, 1.0]]
    with pytest.raises(InvalidValue, match=r"task 'legs', joints: \['a'\] given"):
        task.ordered(["a"], np.zeros((1, 1)))


def test_gains_may_differ_per_row() -> None:
    """A stiffness per axis acts on its own row."""
    model, state = make_model("kuka_lwr"), RobotState(0.0, np.full(7, 0.3), np.zeros(7))
    model.update(state.q, state.v)
    task = FramePositionTask("hand", model, "tool", np.array([1.0, 2.0, 3.0]), 0.0)
    target = task.static_target(task.current(model) + 1.0)
    assert np.allclose(rows_of(task, model, state, target).target, [1.0, 2.0, 3.0], atol=1e-9)


def test_errors_name_the_task_the_field_and_what_was_expected() -> None:
    """Wrong gains, frames and targets are rejected where they enter."""
    model = make_model("kuka_lwr")
    with pytest.raises(UnknownName, match=r"unknown frame 'fist'; known: "):
        FramePositionTask("hand", model, "fist", STIFFNESS, DAMPING)
    with pytest.raises(InvalidValue, match=r"task 'hand', stiffness: \[-1.0, -1.0, -1.0\] given"):
        FramePositionTask("hand", model, "tool", -1.0, DAMPING)
    with pytest.raises(WrongSize, match=r"task 'hand', damping: size \(2,\) given, \(3,\) exp"):
        FramePositionTask("hand", model, "tool", STIFFNESS, np.ones(2))
    task = FramePoseTask("hand", model, "tool", STIFFNESS, DAMPING)
    with pytest.raises(WrongSize, match=r"task 'hand', position: size \(6,\) given, \(7,\)"):
        task.static_target(np.zeros(6))
    with pytest.raises(InvalidValue, match=r"task 'hand', position: quaternion of length 0 given"):
        task.static_target(np.zeros(7))
    with pytest.raises(InvalidValue, match=r"task 'hand', position: .* finite numbers expected"):
        task.static_target(np.full(7, np.nan))


def test_every_kind_of_the_folder_is_known() -> None:
    """The registry finds each file without being told."""
    assert set(TASKS) >= {
        "frame_position",
        "frame_orientation",
        "frame_pose",
        "posture",
        "center_of_mass",
        *RELATIVE,
    }

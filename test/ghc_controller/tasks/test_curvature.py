"""Second-order terms of the tasks against finite differences, fixed and floating base."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from model_states import ROBOTS, make_model, random_state, rows_of

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import (
    quaternion_conjugate,
    quaternion_product,
    rotation_exp,
    rotation_log,
)
from ghc_controller.tasks.center_of_mass import CenterOfMassTask
from ghc_controller.tasks.frame import FrameOrientationTask, FramePoseTask, FramePositionTask
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.tasks.relative_frame import (
    RelativeOrientationTask,
    RelativePoseTask,
    RelativePositionTask,
)
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskTarget

KINDS = (
    "position",
    "axes",
    "orientation",
    "pose",
    "center_of_mass",
    "posture",
    "relative_position",
    "relative_orientation",
    "relative_pose",
)
STEP = 1e-3  # [rad], [m]; fourth-order differences leave about 1e-9


def _task(kind: str, model: RobotModel) -> Task:
    frame = model.frame_names[-1]
    seen = (kind, model, frame, model.frame_names[2], 1.0, 1.0)
    if kind == "relative_position":
        return RelativePositionTask(*seen, axes=("y", "z"))
    if kind == "relative_orientation":
        return RelativeOrientationTask(*seen)
    if kind == "relative_pose":
        return RelativePoseTask(*seen)
    if kind == "position":
        return FramePositionTask(kind, model, frame, 1.0, 1.0)
    if kind == "axes":
        return FramePositionTask(kind, model, frame, 1.0, 1.0, axes=("z", "x"))
    if kind == "orientation":
        return FrameOrientationTask(kind, model, frame, 1.0, 1.0)
    if kind == "pose":
        return FramePoseTask(kind, model, frame, 1.0, 1.0)
    if kind == "center_of_mass":
        return CenterOfMassTask(kind, model, 1.0, 1.0)
    return PostureTask(kind, model, 1.0, 1.0)


def _second(function: Callable[[Array], float], direction: Array) -> float:
    """Second derivative at 0 along a direction, five points."""
    far, near = ([function(s * h * STEP * direction) for s in (-1, 1)] for h in (2, 1))
    middle = function(0.0 * direction)
    return (-sum(far) + 16.0 * sum(near) - 30.0 * middle) / (12.0 * STEP**2)


def _hessian(function: Callable[[Array], float], n: int) -> Array:
    """Hessian at 0 by polarization."""
    eye = np.eye(n)
    own = np.array([_second(function, eye[a]) for a in range(n)])
    hessian = np.diag(own)
    for a in range(n):
        for b in range(a):
            both = _second(function, eye[a] + eye[b])
            hessian[a, b] = hessian[b, a] = 0.5 * (both - own[a] - own[b])
    return hessian


def _variable(task: Task, model: RobotModel, q: Array) -> Callable[[Array], Array]:
    """xi after a step from q; an orientation as the rotation vector away from that at q."""
    model.update(q, np.zeros(model.nv))
    start = task.current(model).copy()

    def value(step: Array) -> Array:
        model.update(model.integrate(q, step), np.zeros(model.nv))
        current = task.current(model)
        if len(current) == task.size:
            return current.copy()
        turned = rotation_log(quaternion_product(current[-4:], quaternion_conjugate(start[-4:])))
        return np.concatenate([current[:-4], turned])

    return value


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
def test_curvature_is_the_second_derivative_of_the_task(kind: str, robot: str) -> None:
    """Seed 1, weights random: agreement to 1e-6 (differences: about 1e-9 / STEP)."""
    rng = np.random.default_rng(1)
    model, q = make_model(robot), random_state(robot, rng).q
    task = _task(kind, model)
    weights = rng.uniform(-1.0, 1.0, task.size)
    value = _variable(task, model, q)
    expected = _hessian(lambda step: float(weights @ value(step)), model.nv)
    model.update(q, np.zeros(model.nv))
    found = task.curvature(model, weights)
    np.testing.assert_array_equal(found, found.T)
    np.testing.assert_allclose(found, expected, atol=1e-6)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [1e-3, 0.5, 1.5])
def test_error_curvature_completes_the_newton_matrix(kind: str, robot: str, size: float) -> None:
    """Seed 2: grad^2 (1/2 |e|^2) = J^T J + S, also for large orientation errors."""
    rng = np.random.default_rng(2)
    model, q = make_model(robot), random_state(robot, rng).q
    task = _task(kind, model)
    model.update(q, np.zeros(model.nv))
    current = task.current(model)
    if len(current) == task.size:
        goal = current + size * rng.uniform(-1.0, 1.0, task.size)
    else:
        turn = rotation_exp(size * rng.uniform(-1.0, 1.0, 3))
        goal = np.concatenate([current[:-4] + size, quaternion_product(turn, current[-4:])])
    target = TaskTarget(goal, np.zeros(task.size), np.zeros(task.size))

    def rows(step: Array) -> tuple[Array, Array]:
        moved = model.integrate(q, step)
        model.update(moved, np.zeros(model.nv))
        found = rows_of(task, model, RobotState(0.0, moved, np.zeros(model.nv)), target)
        return found.error, found.jacobian

    def cost(step: Array) -> float:
        error, _ = rows(step)
        return 0.5 * float(error @ error)

    expected = _hessian(cost, model.nv)
    error, jacobian = rows(np.zeros(model.nv))
    found = jacobian.T @ jacobian + task.error_curvature(model, error)
    np.testing.assert_allclose(found, expected, atol=2e-6 * (1.0 + size))


def test_a_task_without_second_order_term_says_so() -> None:
    class Bare(FramePositionTask):
        curvature = Task.curvature

    model = make_model("kuka_lwr")
    task = Bare("bare", model, model.frame_names[-1], 1.0, 1.0)
    with pytest.raises(InvalidValue, match="bare"):
        task.error_curvature(model, np.zeros(3))

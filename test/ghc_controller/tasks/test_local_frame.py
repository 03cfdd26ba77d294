"""Frames in their own axes: equal gains are those of the world, others turn with the frame."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import ROBOTS, make_model, random_state, rows_of

from ghc_controller.numerics.rotation import quaternion_product, rotation_exp
from ghc_controller.tasks.frame import FrameOrientationTask, FramePoseTask, FramePositionTask
from ghc_controller.tasks.python.local_frame import (
    LocalOrientationTask,
    LocalPoseTask,
    LocalPositionTask,
)
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.tasks.task import Task
from ghc_controller.types import TaskTarget

PAIRS = (
    (LocalPositionTask, FramePositionTask),
    (LocalOrientationTask, FrameOrientationTask),
    (LocalPoseTask, FramePoseTask),
)


def _target(task: Task, position: np.ndarray, rng: np.random.Generator) -> TaskTarget:
    step, velocity, acceleration = rng.uniform(-0.4, 0.4, (3, task.size))
    if len(position) == task.size:
        return TaskTarget(position + step, velocity, acceleration)
    turned = quaternion_product(rotation_exp(step[-3:]), position[-4:])
    return TaskTarget(np.concatenate([position[:-4] + step[:-3], turned]), velocity, acceleration)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize(("local", "world"), PAIRS)
def test_gains_are_those_of_the_axes_of_the_frame(local: type, world: type, robot: str) -> None:
    """R rows_local = rows of the world, whose gains are R diag(k) R^T."""
    rng = np.random.default_rng(3)
    model, state = make_model(robot), random_state(robot, rng)
    frame = model.frame_names[-1]
    for gains in (np.full(6, 30.0), rng.uniform(1.0, 90.0, 6)):
        size = local("t", model, frame, 1.0, 1.0).size
        task = local("t", model, frame, gains[:size], 2.0 * gains[:size])
        reference = world("t", model, frame, 0.0, 0.0)
        model.update(state.q, state.v)
        target = _target(task, reference.current(model), rng)
        ours, theirs = (
            rows_of(task, model, state, target),
            rows_of(reference, model, state, target),
        )
        turn = np.kron(np.eye(size // 3), model.frame_rotation(model.frame_id(frame)))
        stiffness = turn @ np.diag(gains[:size]) @ turn.T
        rate = target.velocity - theirs.jacobian @ state.v
        expected = theirs.target + stiffness @ theirs.error + 2.0 * stiffness @ rate
        assert np.allclose(turn @ ours.jacobian, theirs.jacobian, atol=1e-12)
        assert np.allclose(turn @ ours.error, theirs.error, atol=1e-12)
        assert np.allclose(turn @ ours.target, expected, atol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize(("local", "world"), PAIRS)
def test_the_second_order_term_of_the_error_does_not_depend_on_the_axes(
    local: type, world: type, robot: str
) -> None:
    rng = np.random.default_rng(4)
    model, state = make_model(robot), random_state(robot, rng)
    frame = model.frame_names[-1]
    ours, theirs = local("t", model, frame, 1.0, 1.0), world("t", model, frame, 1.0, 1.0)
    model.update(state.q, state.v)
    target = _target(ours, theirs.current(model), rng)
    mine, expected = (
        task.error_curvature(model, task.measured(model, target).error) for task in (ours, theirs)
    )
    assert np.abs(expected).max() > 1e-3
    assert np.allclose(mine, expected, atol=1e-12)


@pytest.mark.parametrize(("local", "world"), PAIRS)
def test_a_target_that_is_given_again_makes_the_same_rows(local: type, world: type) -> None:
    """Its velocity is turned into the axes of the frame once, however often it is measured."""
    rng = np.random.default_rng(6)
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", rng)
    task = local("t", model, model.frame_names[-1], 30.0, 10.0)
    model.update(state.q, state.v)
    targets = [_target(task, task.current(model), rng)]
    stack, found = TaskStack([task], model.nv), []
    for _ in range(2):
        stack.update(model, state, targets)
        found.append(stack.target.copy())
    assert np.array_equal(*found)
    reference = world("t", model, model.frame_names[-1], 0.0, 0.0)
    rates = (one.measured(model, targets[0]).jacobian @ state.v for one in (task, reference))
    assert np.allclose(task.as_reference(model, next(rates)), next(rates), atol=1e-12)

"""The law of all rows: against its closed form, and other laws in its place."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import ROBOTS, make_model, random_state

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.center_of_mass import CenterOfMassTask
from ghc_controller.tasks.frame import FramePoseTask, FramePositionTask
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget


def _stack(robot: str) -> tuple[TaskStack, RobotModel, RobotState, list[TaskTarget]]:
    """Four tasks with gains of their own per row, updated with references that move."""
    rng = np.random.default_rng(0)
    model, state = make_model(robot), random_state(robot, rng)
    frame = model.frame_names[-1]
    model.update(state.q, state.v)
    tasks: list[Task] = [
        FramePositionTask("hand", model, frame, *rng.uniform(1, 50, (2, 3))),
        CenterOfMassTask("mass", model, *rng.uniform(1, 50, (2, 3))),
        FramePoseTask("pose", model, frame, *rng.uniform(1, 50, (2, 6))),
        PostureTask("posture", model, *rng.uniform(1, 50, (2, model.na))),
    ]
    targets = []
    for task in tasks:
        position = task.current(model)
        position[:3] += rng.uniform(-0.3, 0.3, len(position[:3]))
        targets.append(TaskTarget(position, *rng.uniform(-1.0, 1.0, (2, task.size))))
    stack = TaskStack(tasks, model.nv)
    stack.update(model, state, targets)
    return stack, model, state, targets


@pytest.mark.parametrize("robot", ROBOTS)
def test_targets_are_the_closed_form_of_the_law(robot: str) -> None:
    """Seed 0: xi''* + kp e + kd (xi'* - J v) - J' v, terms from the tasks alone, to 1e-12."""
    stack, model, state, targets = _stack(robot)
    for i, (task, target) in enumerate(zip(stack.tasks, targets, strict=True)):
        found, rows = task.measured(model, target), slice(*stack.starts[i : i + 2])
        velocity_error = target.velocity - found.jacobian @ state.v
        expected = target.acceleration + task.stiffness * found.error
        expected += task.damping * velocity_error - found.drift
        scale = 1.0 + np.abs(expected).max()
        np.testing.assert_allclose(stack.target[rows], expected, rtol=0.0, atol=1e-12 * scale)
        np.testing.assert_array_equal(stack.jacobian[rows], found.jacobian)
        np.testing.assert_array_equal(stack.error_of(i), found.error)


def test_a_reference_at_rest_and_one_that_moves_take_turns() -> None:
    """Rows depend on the reference of this tick alone, whichever came before: seed 1."""
    stack, model, state, moving = _stack("kuka_lwr")
    pairs = zip(stack.tasks, moving, strict=True)
    resting = [task.static_target(target.position) for task, target in pairs]
    for references in (resting, resting, moving, resting, moving, moving):
        stack.update(model, state, references)
        fresh = TaskStack(stack.tasks, model.nv)
        fresh.update(model, state, references)
        np.testing.assert_array_equal(stack.target, fresh.target)


def test_another_law_is_another_function() -> None:
    """A velocity-level law: jacobian @ v -> xi'* + gain e."""

    def velocity_law(rows: TaskRows, velocity: Array, time: float) -> None:
        rows.target[:] = rows.velocity + 5.0 * rows.error

    stack, model, state, targets = _stack("kuka_lwr")
    stack.law = velocity_law
    stack.update(model, state, targets)
    expected = [t.velocity + 5.0 * stack.error_of(i) for i, t in enumerate(targets)]
    np.testing.assert_array_equal(stack.target, np.concatenate(expected))


class _Integral:
    """Integral action of all rows beside the law of the stack before it."""

    def __init__(self, stack: TaskStack, gain: float) -> None:
        self._law, self._gain = stack.law, gain
        self.reset()

    def reset(self) -> None:
        self._sum, self._time = np.zeros(0), np.inf

    def __call__(self, rows: TaskRows, velocity: Array, time: float) -> None:
        self._law(rows, velocity, time)
        if not len(self._sum):
            self._sum = np.zeros(len(rows.error))
        self._sum += max(time - self._time, 0.0) * rows.error
        self._time = time
        rows.target[:] += self._gain * self._sum


def test_a_law_with_memory_is_reset_with_the_stack() -> None:
    """An integral adds gain x time x error of a state held still, and nothing after a reset."""
    stack, model, state, targets = _stack("kuka_lwr")
    plain = stack.target.copy()
    stack.law = _Integral(stack, 2.0)
    for time in (0.0, 0.1, 0.1, 0.3):
        stack.update(model, RobotState(time, state.q, state.v), targets)
    np.testing.assert_allclose(stack.target, plain + 2.0 * 0.3 * stack.error, atol=1e-12)
    stack.reset()
    stack.update(model, RobotState(0.4, state.q, state.v), targets)
    np.testing.assert_array_equal(stack.target, plain)


def test_kinds_of_earlier_versions_are_told_the_new_method() -> None:
    """The interface of TaskRows with the law in every kind is an error at the definition."""
    with pytest.raises(TypeError, match=r"Old.write_rows: it is 'Task.measure' now"):
        type("Old", (PostureTask,), {"write_rows": lambda *_: None})

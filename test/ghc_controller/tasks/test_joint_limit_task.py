"""Task kind joint_limit: rows that are there only near a limit."""

from __future__ import annotations

import numpy as np

from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.tasks.joint_limit import JointLimitTask
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import RobotState, TaskTarget


def test_rows_are_on_beyond_the_margin_alone() -> None:
    """Within it all is zero; beyond it x = kp (edge - q) - kd v: 50 states, seed 3."""
    model = load_robot_config(find_robot("kuka_lwr")).model
    task = JointLimitTask("limits", model, 100.0, 20.0, margin=0.3)
    lower, upper = model.limits.position_lower + 0.3, model.limits.position_upper - 0.3
    rng = np.random.default_rng(3)
    stack, seen = TaskStack([task], model.nv), 0
    for _ in range(50):
        q = rng.uniform(model.limits.position_lower, model.limits.position_upper)
        v = rng.normal(size=model.nv)
        model.update(q, v)
        still = TaskTarget(np.zeros(task.size), np.zeros(task.size), np.zeros(task.size))
        stack.update(model, RobotState(0.0, q, v), [still])
        rows = stack.rows
        beyond = (q < lower) | (q > upper)
        edge = np.where(q < lower, lower, upper)
        seen += int(beyond.sum())
        np.testing.assert_array_equal(rows.jacobian, np.diag(beyond.astype(float)))
        wanted = np.where(beyond, 100.0 * (edge - q) - 20.0 * v, 0.0)
        np.testing.assert_allclose(rows.target, wanted, atol=1e-12)
        np.testing.assert_allclose(rows.error, np.where(beyond, edge - q, 0.0), atol=1e-15)
    assert 0 < seen < 50 * model.nv

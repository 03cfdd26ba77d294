"""Second-order terms of a stack of tasks."""

from __future__ import annotations

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.problem.second_order_terms import SecondOrder
from ghc_controller.tasks.stack import TaskStack


def second_order_terms(stack: TaskStack, model: RobotModel) -> SecondOrder:
    """Terms at the state of the last `stack.update`.

    Raises:
        InvalidValue: a task offers none.
    """
    m, n, k = len(stack.error), model.nv, len(stack.tasks)
    rows, own, error = np.zeros((m, n, n)), np.zeros((k, n, n)), np.zeros(m)
    for i, task in enumerate(stack.tasks):
        if stack.force_rows[i]:
            continue
        first = stack.starts[i]
        error[first : stack.starts[i + 1]] = stack.error_of(i)
        own[i] = task.error_curvature(model, stack.error_of(i))
        for r, weights in enumerate(np.eye(task.size)):
            rows[first + r] = task.curvature(model, weights)
    return SecondOrder(rows, own, error, np.array([task.damping.mean() for task in stack.tasks]))


def check_second_order(stack: TaskStack, model: RobotModel) -> None:
    """Reject tasks that offer no second-order term, before a step asks for it.

    Raises:
        InvalidValue: names the setting and the task.
    """
    try:
        second_order_terms(stack, model)
    except InvalidValue as error:
        raise InvalidValue(f"second_order: {error}; tasks that do, or false, expected") from error

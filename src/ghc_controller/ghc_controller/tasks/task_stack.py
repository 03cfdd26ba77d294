"""The rows of all tasks in one block of memory: the augmented Jacobian, without copying."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.robot_model import RobotModel
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget


class TaskStack:
    """k tasks that write their rows into shared arrays; m is the sum of their sizes.

    Attributes:
        jacobian: (m, n) augmented Jacobian (eq. 10), C-contiguous.
        target: (m,) desired task accelerations minus drift.
        error: (m,) reference - actual.
        starts: (k + 1,) first row of each task, then m.
        rows: one TaskRows a task, views on the arrays above; all are overwritten by `update`.
    """

    def __init__(self, tasks: Sequence[Task], n: int) -> None:
        """Allocate for `tasks` on a robot with n velocity coordinates."""
        self.tasks = tuple(tasks)
        self.starts = np.cumsum([0, *(task.size for task in self.tasks)])
        m = int(self.starts[-1])
        self.jacobian: Array = np.zeros((m, n))
        self.target: Array = np.zeros(m)
        self.error: Array = np.zeros(m)
        blocks = [slice(a, b) for a, b in zip(self.starts[:-1], self.starts[1:], strict=True)]
        self.rows = [TaskRows(self.jacobian[b], self.target[b], self.error[b]) for b in blocks]

    def update(
        self, model: RobotModel, state: RobotState, targets: Sequence[TaskTarget]
    ) -> list[TaskRows]:
        """Linearise every task at the state of the last `model.update`; returns `rows`.

        Args:
            model: updated with `state`.
            state: the same state.
            targets: one per task, in the order of `tasks`.
        """
        rows = self.rows
        for index, task in enumerate(self.tasks):
            rows[index] = task.rows(model, state, targets[index], rows[index])
        return rows

    def reset(self) -> None:
        """Clear what tasks accumulated over time (after a simulation reset)."""
        for task in self.tasks:
            task.reset()

"""The rows of all tasks in one augmented Jacobian, filled in place every tick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskRows


class TaskStack:
    """Augmented Jacobian (eq. 10) and targets of k tasks with m rows in total.

    Attributes:
        jacobian (m, n), target (m,), error (m,): overwritten by `update`.
        starts (k + 1,): first row of each task.
        force_rows: rows under force control, per task.
    """

    def __init__(self, tasks: Sequence[Task], n: int) -> None:
        self.tasks = tuple(tasks)
        sizes = [task.size for task in self.tasks]
        self.starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        m = int(self.starts[-1])
        self.jacobian = np.zeros((m, n))
        self.target = np.zeros(m)
        self.error = np.zeros(m)
        self.force_rows = [0] * len(self.tasks)
        self._rows = [
            TaskRows(self.jacobian[a:b], self.target[a:b], self.error[a:b])
            for a, b in zip(self.starts, self.starts[1:], strict=False)
        ]

    def update(self, model: RobotModel, state: RobotState, references: ReferenceSchedule) -> None:
        """Linearise every task at the state of the last `model.update`."""
        for i, task in enumerate(self.tasks):
            rows = task.rows(model, state, references.target(i, state.time), self._rows[i])
            self.force_rows[i] = rows.force_rows

    def error_of(self, index: int) -> Array:
        """Error of one task, a view (m_i,)."""
        return self._rows[index].error

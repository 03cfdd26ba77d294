"""The rows of all tasks in one augmented Jacobian, filled in place every tick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.law import Law, tracking
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget


class TaskStack:
    """Augmented Jacobian (eq. 10) and targets of k tasks with m rows in total.

    Attributes:
        rows: TaskRows of all tasks, overwritten by `update`.
        jacobian (m, n), target (m,), error (m,): of `rows`.
        starts (k + 1,): first row of each task.
        force_rows: rows under force control, per task.
        law: what makes the targets of all rows, in one call.
    """

    def __init__(self, tasks: Sequence[Task], n: int, law: Law = tracking) -> None:
        self.tasks, self.law = tuple(tasks), law
        sizes = [task.size for task in self.tasks]
        self.starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        self.rows = TaskRows.zeros(int(self.starts[-1]), n)
        rows = self.rows
        self.jacobian, self.target, self.error = rows.jacobian, rows.target, rows.error
        self._blocks = [
            self.rows.block(a, b) for a, b in zip(self.starts, self.starts[1:], strict=False)
        ]
        for task, rows in zip(self.tasks, self._blocks, strict=True):
            rows.stiffness[:], rows.damping[:] = task.stiffness, task.damping
        # where the reference is a point of the task variable, its motion is that of the rows
        self._moved = [task.reference_size == task.size for task in self.tasks]
        self._memories = [
            (i, memory)
            for i, memory in enumerate(task.make_memory() for task in self.tasks)
            if memory is not None
        ]
        self.force_rows = [0] * len(self.tasks)
        self._followed: list[TaskTarget | None] = [None] * len(self.tasks)

    def reset(self) -> None:
        """Forget what tasks and law accumulated over time."""
        for _, memory in self._memories:
            memory.reset()
        reset = getattr(self.law, "reset", None)
        if reset is not None:
            reset()

    def update(
        self, model: RobotModel, state: RobotState, references: Sequence[TaskTarget]
    ) -> None:
        """Measure every task at the state of the last `model.update`, and apply the law.

        Args:
            model: updated with `state`.
            state: the same state; its time and wrenches matter to memories only.
            references: at this time, one per task, with sizes as Task.check_target wants them.
        """
        followed, moved = self._followed, self._moved
        for i, task in enumerate(self.tasks):
            reference, rows = references[i], self._blocks[i]
            if reference is not followed[i] and moved[i]:  # at rest: the same object every tick
                rows.velocity[:], rows.acceleration[:] = reference.velocity, reference.acceleration
                followed[i] = reference
            task.measure(model, reference, rows)
        for i, memory in self._memories:
            rows = self._blocks[i]
            rows.stiffness[:], rows.damping[:] = self.tasks[i].stiffness, self.tasks[i].damping
            self.force_rows[i] = memory.apply(model, state, references[i], rows)
            followed[i] = None  # it may have changed the motion
        self.law(self.rows, model.v, state.time)

    def error_of(self, index: int) -> Array:
        """Error of one task, a view (m_i,)."""
        return self._blocks[index].error

"""The rows of all tasks in one augmented Jacobian, filled in place every tick."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from ghc_controller import core
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.compiled import measured_by_core
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
        self._seen: Sequence[TaskTarget] = ()  # a list that is followed already
        measures = [(i, measured_by_core(task)) for i, task in enumerate(self.tasks)]
        self._measures = [(i, measure) for i, measure in measures if measure is not None]
        self._plugged = [i for i, measure in measures if measure is None]
        # What the core reads the references from, behind one another, and the part of each task.
        sizes = [0 if measure is None else measure.reference_size for _, measure in measures]
        self._references = np.zeros(sum(sizes))
        self._positions = np.split(self._references, np.cumsum(sizes)[:-1]) if sizes else []
        self._model: core.Model | None = None

    def set_gains(self, index: int, **gains: Array) -> None:
        """Change gains of one task for this stack alone: the task of the robot keeps its own.

        Args:
            gains: stiffness [1/s^2] or damping [1/s], (m_i,) numbers >= 0.
        """
        task, rows = copy(self.tasks[index]), self._blocks[index]
        for name, values in gains.items():
            setattr(task, name, np.array(values))
            getattr(rows, name)[:] = values
        self.tasks = (*self.tasks[:index], task, *self.tasks[index + 1 :])

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
        core_stack = self.core_of(model)
        self.follow(references)
        if self.is_compiled:
            core_stack.measure_and_track()
            return
        core_stack.measure()
        for i in self._plugged:
            self.tasks[i].measure(model, references[i], self._blocks[i])
        for i, memory in self._memories:
            rows = self._blocks[i]
            rows.stiffness[:], rows.damping[:] = self.tasks[i].stiffness, self.tasks[i].damping
            self.force_rows[i] = memory.apply(model, state, references[i], rows)
            self._followed[i] = None  # it may have changed the motion
            self._seen = ()
        self.law(self.rows, model.v, state.time)

    @property
    def is_compiled(self) -> bool:
        """Whether the core measures every task, and its law makes the targets."""
        return self.law is tracking and not self._plugged and not self._memories

    def core_of(self, model: RobotModel) -> core.TaskStack:
        """The stack of the core on a model."""
        if model.core is not self._model:
            self._model = model.core
            self._core = self._compiled(model.core)
        return self._core

    def follow(self, references: Sequence[TaskTarget]) -> None:
        """Take references, one per task, with sizes as Task.check_target wants them."""
        if references is self._seen:  # at rest: the same objects every tick
            return
        for i, reference in enumerate(references):
            if reference is not self._followed[i]:
                self._follow(i, reference)
        self._seen = references

    def _compiled(self, model: core.Model) -> core.TaskStack:
        measures = [measure for _, measure in self._measures]
        firsts = [int(self.starts[i]) for i, _ in self._measures]
        rows = self.rows
        return core.TaskStack(
            model, measures, firsts, rows.jacobian, rows.vectors, self._references
        )

    def _follow(self, i: int, reference: TaskTarget) -> None:
        position = self._positions[i]
        if position.size:
            position[:] = reference.position
        if self._moved[i]:
            rows = self._blocks[i]
            rows.velocity[:], rows.acceleration[:] = reference.velocity, reference.acceleration
        self._followed[i] = reference

    def error_of(self, index: int) -> Array:
        """Error of one task, a view (m_i,)."""
        return self._blocks[index].error

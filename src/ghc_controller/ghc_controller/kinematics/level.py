"""One level of a kinematic hierarchy: tasks with references or bounds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.kinematics.level_rows import LevelRows
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, TaskTarget

Target = Array | tuple[Array, Array]  # reference, or lower and upper bound of the task variable


class Level:
    """Tasks of equal priority, either all with a reference or all between bounds.

    Attributes:
        tasks: the tasks; their rows are stacked.
        bounded: targets are pairs (lower, upper), (m,) each, instead of references.
    """

    def __init__(self, *tasks: Task, bounded: bool = False) -> None:
        """Raises InvalidValue without a task, and for bounds on an orientation."""
        if not tasks:
            raise InvalidValue("a level needs at least one task")
        for task in tasks:
            if bounded and task.space is not ReferenceSpace.VECTOR:
                raise InvalidValue(f"task '{task.name}': an orientation cannot be bounded")
        self.tasks, self.bounded = tasks, bounded

    def rows(self, model: RobotModel, targets: Mapping[str, Target]) -> LevelRows:
        """Errors and Jacobians of the tasks at the last `model.update`, made with v = 0.

        Raises:
            UnknownName: the target of a task is missing.
            InvalidValue: bounds where a reference is expected, or vice versa.
        """
        jacobians, lower, upper = [], [], []
        for task in self.tasks:
            if task.name not in targets:
                raise UnknownName("target of task", task.name, targets)
            target = targets[task.name]
            if isinstance(target, tuple) != self.bounded:
                expected = "(lower, upper)" if self.bounded else "a reference"
                raise InvalidValue(f"task '{task.name}': {expected} expected")
            still = np.zeros(task.reference_size)
            reference = task.current(model) if isinstance(target, tuple) else target
            rows = task.measured(model, TaskTarget(reference, still, still))
            jacobians.append(rows.jacobian)
            if isinstance(target, tuple):
                lower.append(target[0] - reference)
                upper.append(target[1] - reference)
            else:
                lower.append(rows.error)
        J = np.vstack(jacobians)
        if self.bounded:
            return LevelRows(J, np.concatenate(lower), np.concatenate(upper), False)
        return LevelRows.equalities(J, np.concatenate(lower))

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """sum over all rows of weights_r grad^2 xi_r, (n, n); weights (m,)."""
        parts = self._split(weights)
        terms = [t.curvature(model, w) for t, w in zip(self.tasks, parts, strict=True)]
        return np.sum(terms, axis=0)

    def error_curvature(self, model: RobotModel, error: Array) -> Array:
        """S (n, n) with grad^2 (1/2 |e|^2) = J^T J + S; error (m,)."""
        parts = self._split(error)
        terms = [t.error_curvature(model, e) for t, e in zip(self.tasks, parts, strict=True)]
        return np.sum(terms, axis=0)

    def _split(self, values: Array) -> list[Array]:
        return np.split(values, np.cumsum([task.size for task in self.tasks])[:-1])

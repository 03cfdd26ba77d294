"""Steps of a robot towards the targets of its tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ghc_controller.kinematics.hierarchy_solver import HierarchySolver
from ghc_controller.kinematics.level import Level, Target
from ghc_controller.kinematics.settings import KinematicSettings
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array


class TaskSolver:
    """Hierarchical inverse kinematics: `step(q, targets) -> dq`, then q := integrate(q, dq).

    Targets are constant within a step; there is no feedforward. Kinematics only: no dynamics, no
    torques.

    Attributes:
        solver: HierarchySolver with the records of the last step.
        levels: highest first.
    """

    def __init__(
        self,
        model: RobotModel,
        levels: Sequence[Level],
        settings: KinematicSettings | None = None,
        joint_limits: bool = True,
    ) -> None:
        """With `joint_limits`, q + dq of actuated joints stays within the model's limits."""
        self.model, self.levels = model, tuple(levels)
        self.solver = HierarchySolver(model.nv, settings)
        self._joint_limits = joint_limits
        self._still = np.zeros(model.nv)
        self._lower, self._upper = np.full(model.nv, -np.inf), np.full(model.nv, np.inf)

    def step(self, q: Array, targets: Mapping[str, Target]) -> Array:
        """dq (n,) [rad], [m] from configuration q (nq,).

        Args:
            targets: by task: a reference, or (lower, upper) in bounded levels.

        Raises:
            UnknownName, InvalidValue: see Level.rows and HierarchySolver.solve.
        """
        model = self.model
        model.update(q, self._still)
        rows = [level.rows(model, targets) for level in self.levels]
        lower = upper = None
        if self._joint_limits:
            lower, upper = self._lower, self._upper
            lower[-model.na :] = model.position_lower - q[-model.na :]
            upper[-model.na :] = model.position_upper - q[-model.na :]
        return self.solver.solve(rows, lower, upper, self._own, self._term)

    def reset(self) -> None:
        """Forget all steps."""
        self.solver.reset()

    def _own(self, level: int, error: Array) -> Array:
        return self.levels[level].error_curvature(self.model, error)

    def _term(self, level: int, weights: Array) -> Array:
        return self.levels[level].curvature(self.model, weights)

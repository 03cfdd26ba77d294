"""A task kind: the sum of all joint positions."""

from __future__ import annotations

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, TaskRows, TaskTarget


class JointSum(Task):
    """One row, xi = sum_i q_i [rad]: the direction in which the last link of a planar arm points.

    Fields: stiffness, damping, reference [rad].
    """

    error_unit = "rad"

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> JointSum:  # noqa: ARG003
        """Build from one entry of `tasks` in robot.yaml."""
        return cls(
            fields.text("name"),
            ("sum",),
            fields.number("stiffness", minimum=0.0),
            fields.number("damping", minimum=0.0),
            np.array([fields.number("reference")]) if fields.has("reference") else None,
        )

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """J = (1, .., 1), without drift."""
        out.error[:] = reference.position - self.current(model)
        out.jacobian[:, -model.na :] = 1.0

    def current(self, model: RobotModel) -> Array:
        """Sum of the joint positions now, (1,) [rad]."""
        return np.array([model.q[-model.na :].sum()])

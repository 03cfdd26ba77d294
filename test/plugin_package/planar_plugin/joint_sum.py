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

    def write_rows(self, model: RobotModel, target: TaskTarget, out: TaskRows) -> None:
        """J = (1, .., 1), without drift."""
        jacobian = np.zeros((1, model.nv))
        jacobian[:, -model.na :] = 1.0
        error = target.position - self.current(model)
        velocity_error = target.velocity - jacobian @ model.v
        self.fill(out, jacobian, np.zeros(1), error, velocity_error, target.acceleration)

    def current(self, model: RobotModel) -> Array:
        """Sum of the joint positions now, (1,) [rad]."""
        return np.array([model.q[-model.na :].sum()])

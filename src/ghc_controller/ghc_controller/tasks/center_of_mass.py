"""Position of the robot's centre of mass."""

from __future__ import annotations

import numpy as np

from ghc_controller.config import Fields
from ghc_controller.robot_model import RobotModel
from ghc_controller.tasks.frame_position import WORLD_AXES
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget


@register_task("center_of_mass")
class CenterOfMassTask(Task):
    """xi = chosen world coordinates of the centre of mass [m].

    Fields: stiffness, damping, axes (default [x, y, z]), reference (optional position).
    """

    def __init__(
        self,
        name: str,
        stiffness: float | Array,
        damping: float | Array,
        axes: tuple[str, ...] = WORLD_AXES,
        reference: Array | None = None,
    ) -> None:
        """See Task for the gains."""
        super().__init__(name, axes, stiffness, damping, reference)
        self._axes = np.array([WORLD_AXES.index(axis) for axis in axes])

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> CenterOfMassTask:
        """Build from one entry of `tasks` in robot.yaml."""
        axes = fields.names("axes", WORLD_AXES, default=WORLD_AXES)
        reference = None
        if fields.has("reference"):
            reference = np.array(fields.numbers("reference", len(axes)))
        return cls(
            fields.text("name"),
            np.array(fields.numbers("stiffness", len(axes))),
            np.array(fields.numbers("damping", len(axes))),
            axes,
            reference,
        )

    def write_rows(
        self, model: RobotModel, state: RobotState, target: TaskTarget, out: TaskRows
    ) -> int:
        """Rows on the velocity of the centre of mass."""
        axes = self._axes
        self.fill(
            out,
            model.center_of_mass_jacobian()[axes],
            model.center_of_mass_drift()[axes],
            target.position - model.center_of_mass()[axes],
            target.velocity - model.center_of_mass_velocity()[axes],
            target.acceleration,
        )
        return 0

    def current(self, model: RobotModel) -> Array:
        """Chosen coordinates of the centre of mass now, (m,) [m]."""
        return model.center_of_mass()[self._axes]

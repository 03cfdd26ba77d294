"""Position of the robot's center of mass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.core import CenterMeasure
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import Distinct
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.compiled import CompiledTask
from ghc_controller.tasks.curvature import point_curvature
from ghc_controller.tasks.force_control import WORLD_AXES
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import TaskFields
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class CenterOfMassFields(TaskFields):
    """Fields of `kind: center_of_mass`."""

    axes: tuple[str, ...] = declared(
        "rows of the task, world axes", WORLD_AXES, domain=Distinct(WORLD_AXES), empty=False
    )
    reference: tuple[float, ...] | None = declared(
        "standing position, one number per axis", None, unit="m", per_row=True
    )


@register_task("center_of_mass")
class CenterOfMassTask(CompiledTask):
    """xi = chosen world coordinates of the center of mass [m].

    Fields: stiffness, damping, axes (default [x, y, z]), reference (optional position).
    """

    entry: ClassVar[type[CenterOfMassFields]] = CenterOfMassFields

    def __init__(
        self,
        name: str,
        model: RobotModel,
        stiffness: ArrayLike,
        damping: ArrayLike,
        axes: tuple[str, ...] = WORLD_AXES,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task for the gains.

        Raises:
            InvalidValue: the model has no mass.
        """
        if not model.mass > 0.0:
            raise InvalidValue(f"task '{name}': the robot has no mass, thus no center of mass")
        rows = [WORLD_AXES.index(axis) for axis in axes]
        super().__init__(name, axes, stiffness, damping, CenterMeasure(rows), reference)
        self._axes = np.array(rows)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> CenterOfMassTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, rows=lambda v: len(v["axes"]))
        gains = given.stiffness, given.damping
        return cls(given.name, model, *gains, given.axes, given.reference)

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """Second-order term of the coordinates of the center of mass: see Task."""
        along = np.zeros(3)
        along[self._axes] = weights
        return point_curvature(model, model.angular_axes(), model.center_of_mass_jacobian(), along)

    def current(self, model: RobotModel) -> Array:
        """Chosen coordinates of the center of mass now, (m,) [m]."""
        return model.center_of_mass()[self._axes]

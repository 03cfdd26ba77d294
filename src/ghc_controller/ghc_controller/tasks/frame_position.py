"""Position of a frame's origin along chosen world axes, with force control once in contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import Distinct
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.curvature import point_curvature
from ghc_controller.tasks.force_control import WORLD_AXES, ForceControl, ForceFields
from ghc_controller.tasks.kernels import position_rows
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task, TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class FramePositionFields(TaskFields):
    """Fields of `kind: frame_position`."""

    frame: str = declared("frame of the URDF", names="frame")
    axes: tuple[str, ...] = declared(
        "rows of the task, world axes", WORLD_AXES, domain=Distinct(WORLD_AXES), empty=False
    )
    reference: tuple[float, ...] | None = declared(
        "standing position, one number per axis", None, unit="m", per_row=True
    )
    force: Fields | None = declared(
        "force control of some axes while in contact", None, later=ForceFields
    )


@register_task("frame_position")
class FramePositionTask(Task):
    """xi = chosen world coordinates of the frame's origin [m]; target positions likewise.

    Fields: frame, stiffness, damping, axes (default [x, y, z]), reference (optional standing
    position, one number per axis), force (optional, see ForceControl).
    """

    entry: ClassVar[type[FramePositionFields]] = FramePositionFields

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        stiffness: float | Array,
        damping: float | Array,
        axes: tuple[str, ...] = WORLD_AXES,
        reference: Array | None = None,
        force: ForceControl | None = None,
    ) -> None:
        """See Task for the gains; `force` belongs to the same frame and axes.

        Raises:
            UnknownName: no such frame; lists those that exist.
        """
        super().__init__(name, axes, stiffness, damping, reference)
        self.frame = frame
        self.force = force
        self._frame_id = model.frame_id(frame)
        self._axes = np.array([WORLD_AXES.index(axis) for axis in axes])

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> FramePositionTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(
            fields, cls.entry, names={"frame": model.frame_names}, rows=lambda v: len(v["axes"])
        )
        force = None
        if given.force is not None:
            force = ForceControl.from_config(given.force, model.frame_id(given.frame), given.axes)
        return cls(
            given.name,
            model,
            given.frame,
            np.array(given.stiffness),
            np.array(given.damping),
            given.axes,
            None if given.reference is None else np.array(given.reference),
            force,
        )

    def write_rows(self, model: RobotModel, target: TaskTarget, out: TaskRows) -> None:
        """Rows on the linear velocity of the origin in world axes."""
        frame = model.frame(self._frame_id)
        position_rows(
            frame.position,
            frame.jacobian,
            frame.velocity,
            frame.drift,
            self._axes,
            target.position,
            target.velocity,
            target.acceleration,
            self.stiffness,
            self.damping,
            out.jacobian,
            out.target,
            out.error,
        )

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """Second-order term of the origin's coordinates: see Task."""
        along = np.zeros(3)
        along[self._axes] = weights
        jacobian = model.frame_jacobian(self._frame_id)
        return point_curvature(model, jacobian[3:], jacobian[:3], along)

    def current(self, model: RobotModel) -> Array:
        """Chosen coordinates of the origin now, (m,) [m]."""
        return model.frame_position(self._frame_id)[self._axes]

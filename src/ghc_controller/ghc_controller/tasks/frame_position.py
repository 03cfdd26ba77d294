"""Position of a frame's origin along chosen world axes, with force control once in contact."""

from __future__ import annotations

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.curvature import point_curvature
from ghc_controller.tasks.force_control import WORLD_AXES, ForceControl
from ghc_controller.tasks.kernels import position_rows
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, TaskRows, TaskTarget


@register_task("frame_position")
class FramePositionTask(Task):
    """xi = chosen world coordinates of the frame's origin [m]; target positions likewise.

    Fields: frame, stiffness, damping, axes (default [x, y, z]), reference (optional standing
    position, one number per axis), force (optional, see ForceControl).
    """

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
        frame = fields.choice("frame", model.frame_names)
        axes = fields.names("axes", WORLD_AXES, default=WORLD_AXES)
        force = None
        if fields.has("force"):
            force = ForceControl.from_config(fields.section("force"), model.frame_id(frame), axes)
        reference = None
        if fields.has("reference"):
            reference = np.array(fields.numbers("reference", len(axes)))
        return cls(
            fields.text("name"),
            model,
            frame,
            np.array(fields.numbers("stiffness", len(axes))),
            np.array(fields.numbers("damping", len(axes))),
            axes,
            reference,
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

"""Position and orientation of a frame as one task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import quaternion_from_matrix
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.schema.declared import declared
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.curvature import (
    point_curvature,
    rotation_curvature,
    rotation_error_curvature,
)
from ghc_controller.tasks.orientation_kernels import pose_rows
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task, TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class FramePoseFields(TaskFields):
    """Fields of `kind: frame_pose`."""

    frame: str = declared("frame of the URDF", names="frame")
    reference: tuple[float, ...] | None = declared(
        "standing pose: x, y, z [m], then a quaternion x, y, z, w", None, size=7
    )


@register_task("frame_pose")
class FramePoseTask(Task):
    """Six rows: position [m] then orientation [rad] of a frame, in world axes.

    References are x, y, z, qx, qy, qz, qw; velocity and acceleration are linear then angular.
    Errors are those of FramePositionTask and FrameOrientationTask.

    Fields: frame, stiffness, damping (one number or six), reference (optional, seven numbers).
    """

    entry: ClassVar[type[FramePoseFields]] = FramePoseFields
    space = ReferenceSpace.POSE
    error_unit = "m, rad"

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        stiffness: float | Array,
        damping: float | Array,
        reference: Array | None = None,
    ) -> None:
        """See Task for the gains.

        Raises:
            UnknownName: no such frame; lists those that exist.
        """
        super().__init__(name, ("x", "y", "z", "rx", "ry", "rz"), stiffness, damping, reference)
        self.frame = frame
        self._frame_id = model.frame_id(frame)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> FramePoseTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, names={"frame": model.frame_names}, rows=lambda _: 6)
        return cls(
            given.name,
            model,
            given.frame,
            np.array(given.stiffness),
            np.array(given.damping),
            None if given.reference is None else np.array(given.reference),
        )

    def write_rows(self, model: RobotModel, target: TaskTarget, out: TaskRows) -> None:
        """Rows on the linear and angular velocity of the frame in world axes."""
        frame = model.frame(self._frame_id)
        pose_rows(
            frame.position,
            frame.rotation,
            frame.jacobian,
            frame.velocity,
            frame.drift,
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
        """Sum of those of FramePositionTask and FrameOrientationTask."""
        jacobian = model.frame_jacobian(self._frame_id)
        moved = point_curvature(model, jacobian[3:], jacobian[:3], weights[:3])
        return moved + rotation_curvature(model, jacobian[3:], weights[3:])

    def error_curvature(self, model: RobotModel, error: Array) -> Array:
        """Sum of those of FramePositionTask and FrameOrientationTask."""
        jacobian = model.frame_jacobian(self._frame_id)
        moved = point_curvature(model, jacobian[3:], jacobian[:3], -error[:3])
        return moved + rotation_error_curvature(model, jacobian[3:], error[3:])

    def current(self, model: RobotModel) -> Array:
        """Position and quaternion of the frame now, (7,)."""
        frame = model.frame(self._frame_id)
        return np.concatenate([frame.position, quaternion_from_matrix(frame.rotation)])

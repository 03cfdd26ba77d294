"""Position and orientation of a frame as one task."""

from __future__ import annotations

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import quaternion_from_matrix
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.curvature import (
    point_curvature,
    rotation_curvature,
    rotation_error_curvature,
)
from ghc_controller.tasks.orientation_kernels import pose_rows
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, TaskRows, TaskTarget


@register_task("frame_pose")
class FramePoseTask(Task):
    """Six rows: position [m] then orientation [rad] of a frame, in world axes.

    References are x, y, z, qx, qy, qz, qw; velocity and acceleration are linear then angular.
    Errors are those of FramePositionTask and FrameOrientationTask.

    Fields: frame, stiffness, damping (one number or six), reference (optional, seven numbers).
    """

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
        reference = np.array(fields.numbers("reference", 7)) if fields.has("reference") else None
        return cls(
            fields.text("name"),
            model,
            fields.choice("frame", model.frame_names),
            np.array(fields.numbers("stiffness", 6)),
            np.array(fields.numbers("damping", 6)),
            reference,
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

"""Orientation of a frame."""

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
from ghc_controller.tasks.curvature import rotation_curvature, rotation_error_curvature
from ghc_controller.tasks.orientation_kernels import orientation_rows
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task, TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameOrientationFields(TaskFields):
    """Fields of `kind: frame_orientation`."""

    frame: str = declared("frame of the URDF", names="frame")
    reference: tuple[float, ...] | None = declared(
        "standing orientation: quaternion x, y, z, w", None, unit="-", size=4
    )


@register_task("frame_orientation")
class FrameOrientationTask(Task):
    """Rotation R of a frame; references are unit quaternions x, y, z, w (frame to world).

    Error e = log(R* R^T) [rad]: the rotation vector in world axes that turns the frame onto its
    reference. Rows act on the angular velocity w = J v in world axes:
        J dv -> w*' + stiffness e + damping (w* - w) - J' v.
    Exactly, e' = J_l(e)^-1 w* - J_r(e)^-1 w, with the left and right Jacobians of rotation.py;
    w* - w stands for e' to first order. Along e the two agree for every e, since J_l(e)^T e =
    J_r(e)^T e = e, so that |e|' = e . (w* - w) / |e|: the law contracts the error up to |e| = pi,
    where its direction jumps.

    Fields: frame, stiffness, damping, reference (optional quaternion).
    """

    entry: ClassVar[type[FrameOrientationFields]] = FrameOrientationFields
    space = ReferenceSpace.ORIENTATION
    error_unit = "rad"

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
        super().__init__(name, ("rx", "ry", "rz"), stiffness, damping, reference)
        self.frame = frame
        self._frame_id = model.frame_id(frame)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> FrameOrientationTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, names={"frame": model.frame_names}, rows=lambda _: 3)
        return cls(
            given.name,
            model,
            given.frame,
            np.array(given.stiffness),
            np.array(given.damping),
            None if given.reference is None else np.array(given.reference),
        )

    def write_rows(self, model: RobotModel, target: TaskTarget, out: TaskRows) -> None:
        """Rows on the angular velocity in world axes."""
        frame = model.frame(self._frame_id)
        orientation_rows(
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
        """Second-order term of the rotation vector that leads away from the orientation now."""
        return rotation_curvature(model, model.frame_jacobian(self._frame_id)[3:], weights)

    def error_curvature(self, model: RobotModel, error: Array) -> Array:
        """See Task; with the part by which log(R* R^T) is no linear function of the rotation."""
        return rotation_error_curvature(model, model.frame_jacobian(self._frame_id)[3:], error)

    def current(self, model: RobotModel) -> Array:
        """Quaternion x, y, z, w of the frame now, (4,)."""
        return quaternion_from_matrix(model.frame_rotation(self._frame_id))

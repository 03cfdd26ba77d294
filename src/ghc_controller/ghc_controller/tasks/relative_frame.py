"""One frame seen from another frame of the robot: position, orientation or pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.core import FrameMeasure, SeenFrame
from ghc_controller.errors import InvalidValue
from ghc_controller.model.frames import FrameTerms
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import Distinct
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.curvature import point_curvature, rotation_curvature
from ghc_controller.tasks.force_control import WORLD_AXES
from ghc_controller.tasks.frame import POSE_ROWS, TURNS, FrameTask
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import TaskFields
from ghc_controller.types import Array


class FromFrame:
    """Frame B as seen from frame A, in the axes of A.

    With r = p_B - p_A in world axes and R_A the rotation of A,
        p = R_A^T r,    p' = R_A^T (v_B - v_A - w_A x r),
        R = R_A^T R_B,  w = R_A^T (w_B - w_A).
    """

    def __init__(self, model: RobotModel, frame: str, base: str) -> None:
        """See A as `base`, B as `frame`.

        Raises:
            UnknownName: no such frame; lists those that exist.
        """
        self._frame_id, self._base_id = model.frame_id(frame), model.frame_id(base)
        self._seen = SeenFrame(model.nv)
        self._terms = FrameTerms.of(self._seen.arrays())

    def measure(self, rows: Sequence[int]) -> FrameMeasure:
        """See Sight."""
        return FrameMeasure(list(rows), self._frame_id, self._base_id)

    def terms(self, model: RobotModel) -> FrameTerms:
        """See Sight; arrays that the next call overwrites."""
        self._seen.update(model.core, self._base_id, self._frame_id)
        return self._terms

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """See Sight.

        With R_A(q + dq) = exp(a) R_A and R_B alike with b, to second order in dq,
            p = R_A^T (I - [a] + [a]^2 / 2) r,    phi = R_A^T (b - a - a x b / 2).
        """
        base, frame = model.frame(self._base_id), model.frame(self._frame_id)
        A, B = base.jacobian[3:], frame.jacobian[3:]
        term = np.zeros((model.nv, model.nv))
        if weights[:3].any():
            W, r = base.rotation @ weights[:3], frame.position - base.position
            moved = frame.jacobian[:3] - base.jacobian[:3]
            term += point_curvature(model, B, frame.jacobian[:3], W)
            term -= point_curvature(model, A, base.jacobian[:3], W)
            term -= rotation_curvature(model, A, np.cross(r, W))
            turned = 0.5 * np.outer(r @ A, W @ A) - A.T @ np.cross(moved, W, axis=0)
            term += turned + turned.T - (W @ r) * (A.T @ A)
        if weights[3:].any():
            W = base.rotation @ weights[3:]
            term += rotation_curvature(model, B, W) - rotation_curvature(model, A, W)
            turned = 0.5 * (A.T @ np.cross(B, W, axis=0))
            term -= turned + turned.T
        return 0.5 * (term + term.T)


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativeFields(TaskFields):
    """Fields of all kinds of this file."""

    frame: str = declared("frame of the URDF that is seen", names="frame")
    relative_to: str = declared("frame of the URDF that it is seen from", names="frame")
    reference: tuple[float, ...] | None = None  # of each kind, declared there


class RelativeFrameTask(FrameTask):
    """Coordinates of `frame` as seen from `relative_to`, in the axes of `relative_to`.

    References, their velocities and accelerations are in these axes as well. Where both frames
    move together, as two hands do that carry one object, it asks for no motion.

    Attributes:
        relative_to: name of the frame it is seen from.
    """

    entry: ClassVar[type[RelativeFields]] = RelativeFields
    selection: ClassVar[tuple[str, ...]]

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        relative_to: str,
        stiffness: ArrayLike,
        damping: ArrayLike,
        reference: ArrayLike | None = None,
        axes: tuple[str, ...] = (),
    ) -> None:
        """See Task for the gains; `axes` are those of a position, none means all rows.

        Raises:
            UnknownName: no such frame; lists those that exist.
            InvalidValue: both frames are the same.
        """
        if frame == relative_to:
            raise InvalidValue(
                f"task '{name}', relative_to: another frame than '{frame}' expected"
            )
        sight = FromFrame(model, frame, relative_to)
        labels = axes or self.selection
        super().__init__(name, frame, sight, labels, stiffness, damping, reference)
        self.relative_to = relative_to

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> RelativeFrameTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(
            fields,
            cls.entry,
            names={"frame": model.frame_names},
            rows=lambda v: len(v.get("axes", cls.selection)),
        )
        gains, axes = (given.stiffness, given.damping), getattr(given, "axes", ())
        reference = given.reference
        return cls(given.name, model, given.frame, given.relative_to, *gains, reference, axes)


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativePositionFields(RelativeFields):
    """Fields of `kind: relative_position`."""

    axes: tuple[str, ...] = declared(
        "rows of the task, axes of relative_to",
        WORLD_AXES,
        domain=Distinct(WORLD_AXES),
        empty=False,
    )
    reference: tuple[float, ...] | None = declared(
        "standing position, one number per axis", None, unit="m", per_row=True
    )


@register_task("relative_position")
class RelativePositionTask(RelativeFrameTask):
    """Chosen coordinates of the origin of `frame` [m]."""

    entry = RelativePositionFields
    selection = WORLD_AXES


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativeOrientationFields(RelativeFields):
    """Fields of `kind: relative_orientation`."""

    reference: tuple[float, ...] | None = declared(
        "standing orientation: quaternion x, y, z, w", None, unit="-", size=4
    )


@register_task("relative_orientation")
class RelativeOrientationTask(RelativeFrameTask):
    """Rotation of `frame`; references are unit quaternions x, y, z, w (frame to relative_to)."""

    entry = RelativeOrientationFields
    selection = TURNS
    space = ReferenceSpace.ORIENTATION
    error_unit = "rad"


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativePoseFields(RelativeFields):
    """Fields of `kind: relative_pose`."""

    reference: tuple[float, ...] | None = declared(
        "standing pose: x, y, z [m], then a quaternion x, y, z, w", None, size=7
    )


@register_task("relative_pose")
class RelativePoseTask(RelativeFrameTask):
    """Six rows: position [m], then orientation [rad] of `frame`."""

    entry = RelativePoseFields
    selection = POSE_ROWS
    space = ReferenceSpace.POSE
    error_unit = "m, rad"

"""Frames: position, orientation or pose, three selections of the same six rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.rotation import quaternion_from_matrix
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import Distinct
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.compiled import CompiledTask
from ghc_controller.tasks.curvature import rotation_error_term
from ghc_controller.tasks.force_control import WORLD_AXES, ForceControl, ForceFields
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.sight import FromWorld, Sight
from ghc_controller.tasks.task import TaskFields
from ghc_controller.types import Array

TURNS = ("rx", "ry", "rz")
POSE_ROWS = (*WORLD_AXES, *TURNS)


class FrameTask(CompiledTask):
    """Chosen coordinates of a frame: of its origin [m], then all three of its rotation R [rad].

    The error of a rotation is e = log(R* R^T): the rotation vector that turns the frame onto its
    reference; its rows act on the angular velocity w = J v. Exactly, e' = J_l(e)^-1 w* -
    J_r(e)^-1 w, with the left and right Jacobians of rotation.py; w* - w stands for e' to first
    order. Along e the two agree for every e, since J_l(e)^T e = J_r(e)^T e = e, so that |e|' =
    e . (w* - w) / |e|: the law contracts the error up to |e| = pi, where its direction jumps.

    Attributes:
        frame: name of the frame.
    """

    def __init__(
        self,
        name: str,
        frame: str,
        sight: Sight,
        labels: Sequence[str],
        stiffness: ArrayLike,
        damping: ArrayLike,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task for the gains; `labels` are some of x, y, z, then rx, ry, rz or none."""
        rows = [POSE_ROWS.index(label) for label in labels]
        super().__init__(name, labels, stiffness, damping, sight.measure(rows), reference)
        self.frame = frame
        self._sight = sight
        self._rows = np.array(rows)
        self._places = self._rows[self._rows < len(WORLD_AXES)]  # rows of the position
        self._turns = len(self._places) < len(self._rows)

    def current(self, model: RobotModel) -> Array:
        """Chosen coordinates of the origin [m], then a quaternion x, y, z, w if it turns."""
        frame = self._sight.terms(model)
        position = frame.position[self._places]
        if not self._turns:
            return position
        return np.concatenate([position, quaternion_from_matrix(frame.rotation)])

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """See Task; of a rotation: of the vector that leads away from the orientation now."""
        along = np.zeros(len(POSE_ROWS))
        along[self._rows] = weights
        return self._sight.curvature(model, along)

    def error_curvature(self, model: RobotModel, error: Array) -> Array:
        """See Task; with the part by which log(R* R^T) is no linear function of the rotation."""
        return self._rotation_term(model, error) - self.curvature(model, error)

    def _rotation_term(self, model: RobotModel, error: Array) -> Array:
        """(n, n) second-order term of log(R* R^T); zeros without a rotation."""
        if not self._turns:
            return np.zeros((model.nv, model.nv))
        return rotation_error_term(self._sight.terms(model).jacobian[3:], error[-3:])


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
class FramePositionTask(FrameTask):
    """xi = chosen world coordinates of the frame's origin [m]; target positions likewise."""

    entry: ClassVar[type[FramePositionFields]] = FramePositionFields

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        stiffness: ArrayLike,
        damping: ArrayLike,
        axes: tuple[str, ...] = WORLD_AXES,
        reference: ArrayLike | None = None,
        force: ForceControl | None = None,
    ) -> None:
        """See Task for the gains; `force` belongs to the same frame and axes.

        Raises:
            UnknownName: no such frame; lists those that exist.
        """
        sight = FromWorld(model.frame_id(frame))
        super().__init__(name, frame, sight, axes, stiffness, damping, reference)
        self.force = force

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> FramePositionTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(
            fields, cls.entry, names={"frame": model.frame_names}, rows=lambda v: len(v["axes"])
        )
        force = None
        if given.force is not None:
            force = ForceControl.from_config(given.force, model.frame_id(given.frame), given.axes)
        gains = given.stiffness, given.damping
        return cls(given.name, model, given.frame, *gains, given.axes, given.reference, force)


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameOrientationFields(TaskFields):
    """Fields of `kind: frame_orientation`."""

    frame: str = declared("frame of the URDF", names="frame")
    reference: tuple[float, ...] | None = declared(
        "standing orientation: quaternion x, y, z, w", None, unit="-", size=4
    )


class WholeFrameTask(FrameTask):
    """All three rows of a rotation, with those of the position or without."""

    entry: ClassVar[type[Any]]  # with `frame` and `reference`
    selection: ClassVar[tuple[str, ...]]

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        stiffness: ArrayLike,
        damping: ArrayLike,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task for the gains.

        Raises:
            UnknownName: no such frame; lists those that exist.
        """
        sight = FromWorld(model.frame_id(frame))
        super().__init__(name, frame, sight, self.selection, stiffness, damping, reference)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> WholeFrameTask:
        """Build from one entry of `tasks` in robot.yaml."""
        names = {"frame": model.frame_names}
        given = read(fields, cls.entry, names=names, rows=lambda _: len(cls.selection))
        gains = given.stiffness, given.damping
        return cls(given.name, model, given.frame, *gains, given.reference)


@register_task("frame_orientation")
class FrameOrientationTask(WholeFrameTask):
    """Rotation of a frame; references are unit quaternions x, y, z, w (frame to world)."""

    entry = FrameOrientationFields
    selection = TURNS
    space = ReferenceSpace.ORIENTATION
    error_unit = "rad"


@dataclass(frozen=True, slots=True, kw_only=True)
class FramePoseFields(TaskFields):
    """Fields of `kind: frame_pose`."""

    frame: str = declared("frame of the URDF", names="frame")
    reference: tuple[float, ...] | None = declared(
        "standing pose: x, y, z [m], then a quaternion x, y, z, w", None, size=7
    )


@register_task("frame_pose")
class FramePoseTask(WholeFrameTask):
    """Six rows: position [m], then orientation [rad] of a frame, in world axes.

    References are x, y, z, qx, qy, qz, qw; velocity and acceleration are linear, then angular.
    """

    entry = FramePoseFields
    selection = POSE_ROWS
    space = ReferenceSpace.POSE
    error_unit = "m, rad"

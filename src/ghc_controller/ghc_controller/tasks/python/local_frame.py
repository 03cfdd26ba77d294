"""Frames with rows and gains along their own axes; references stay in the world."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.schema.declared import declared
from ghc_controller.tasks.force_control import WORLD_AXES
from ghc_controller.tasks.frame import (
    POSE_ROWS,
    TURNS,
    FrameOrientationFields,
    FramePoseFields,
    WholeFrameTask,
)
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget


class LocalFrameTask(WholeFrameTask):
    """The rows of a WholeFrameTask turned into the axes of the frame.

    With R the rotation of the frame and index w for world axes,
        e = R^T e_w,  J = R^T J_w,  drift = R^T drift_w,  v* = R^T v*_w,  a* = R^T a*_w.
    With the same gain on all three axes the law is that of the world. With other gains, stiffness
    and damping in world axes are R diag(k) R^T: they turn with the frame, as for a tool that is
    stiff along its axis and soft across.
    """

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """See Task."""
        super().measure(model, reference, out)
        turn = self._sight.terms(model).rotation.T
        # Anew: they still hold what this task wrote for the state before.
        out.velocity[:], out.acceleration[:] = reference.velocity, reference.acceleration
        for first in range(0, self.size, 3):
            rows = slice(first, first + 3)
            for values in (out.jacobian, out.error, out.drift, out.velocity, out.acceleration):
                values[rows] = turn @ values[rows]

    def as_reference(self, model: RobotModel, values: Array) -> Array:
        """See Task: R v."""
        return self._in_world(model, values)

    def curvature(self, model: RobotModel, weights: Array) -> Array:
        """See Task; along the axes that the frame has at this state."""
        return super().curvature(model, self._in_world(model, weights))

    def error_curvature(self, model: RobotModel, error: Array) -> Array:
        """See Task; the length of the error is that in world axes."""
        world = self._in_world(model, error)
        return self._rotation_term(model, world) - super().curvature(model, world)

    def _in_world(self, model: RobotModel, values: Array) -> Array:
        rotation = self._sight.terms(model).rotation
        return (values.reshape(-1, 3) @ rotation.T).ravel()


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalPositionFields(TaskFields):
    """Fields of `kind: local_position`."""

    frame: str = declared("frame of the URDF, whose axes the rows have", names="frame")
    reference: tuple[float, ...] | None = declared(
        "standing position x, y, z in the world", None, unit="m", size=3
    )


@register_task("local_position")
class LocalPositionTask(LocalFrameTask):
    """Origin of a frame [m]: references in the world, rows along the axes of the frame."""

    entry = LocalPositionFields
    selection = WORLD_AXES


@register_task("local_orientation")
class LocalOrientationTask(LocalFrameTask):
    """Rotation of a frame, about its own axes; references are unit quaternions x, y, z, w."""

    entry = FrameOrientationFields
    selection = TURNS
    space = ReferenceSpace.ORIENTATION
    error_unit = "rad"


@register_task("local_pose")
class LocalPoseTask(LocalFrameTask):
    """Six rows along and about the axes of a frame; references as of `frame_pose`."""

    entry = FramePoseFields
    selection = POSE_ROWS
    space = ReferenceSpace.POSE
    error_unit = "m, rad"

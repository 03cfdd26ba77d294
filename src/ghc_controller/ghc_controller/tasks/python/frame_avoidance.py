"""Distance of a frame from an obstacle that is its reference: one row along the line between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.numerics.minimum_jerk import minimum_jerk
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.tasks.force_control import WORLD_AXES
from ghc_controller.tasks.registry import register_task
from ghc_controller.tasks.task import Task, TaskFields
from ghc_controller.types import Array, TaskRows, TaskTarget

_CLOSEST = 1e-6  # [m] a frame nearer than this to the obstacle has no direction away from it
_ABSENT = 10.0  # [m] above the frame: where an obstacle without a reference is


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameAvoidanceFields(TaskFields):
    """Fields of `kind: frame_avoidance`."""

    frame: str = declared("frame of the URDF", names="frame")
    distance: float = declared("to be kept", unit="m", domain=NOT_NEGATIVE)
    near: float = declared("distance from which on this is in full force", unit="m")
    far: float = declared("distance from which on only damping is left", unit="m")
    radius: float = declared("of the obstacle", 0.0, unit="m", domain=NOT_NEGATIVE)
    reference: tuple[float, ...] | None = declared(
        "standing position of the obstacle; left out = far above", None, unit="m", size=3
    )


@register_task("frame_avoidance")
class FrameAvoidanceTask(Task):
    """xi = distance d of the frame's origin from the obstacle minus `radius` [m].

    The reference is the position of the obstacle in the world, with its velocity and acceleration.
    With n the unit vector from obstacle to frame, J = n^T J_p and d' = n^T (v_p - v_o), the local
    controller keeps `distance` once the obstacle is near, and brings the frame to rest along n
    while it is far:

        xi''_d = h (stiffness (distance - d) - damping d' - c + n^T a_o) - (1 - h) damping n^T v_p

    c = (|v_p - v_o|^2 - d'^2) / |p - o| is the part of d'' that turns n, and h goes smoothly from
    0 at d = `far` to 1 at d = `near`.

    Fields: frame, stiffness, damping, distance, near, far, radius (default 0), reference (optional
    standing position of the obstacle; without one it is 10 m above the frame).
    """

    entry: ClassVar[type[FrameAvoidanceFields]] = FrameAvoidanceFields

    def __init__(
        self,
        name: str,
        model: RobotModel,
        frame: str,
        stiffness: ArrayLike,
        damping: ArrayLike,
        distance: float,
        near: float,
        far: float,
        radius: float = 0.0,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task for the gains; `distance`, `near`, `far` and `radius` in [m].

        Raises:
            UnknownName: no such frame; lists those that exist.
            InvalidValue: `near` is not below `far`.
        """
        if not near < far:
            raise InvalidValue(
                f"task '{name}', near: {near:g} m given, less than far = {far:g} m expected"
            )
        super().__init__(name, ("distance",), stiffness, damping, reference)
        self.frame = frame
        self.distance, self.near, self.far, self.radius = distance, near, far, radius
        self._frame_id = model.frame_id(frame)

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> FrameAvoidanceTask:
        """Build from one entry of `tasks` in robot.yaml."""
        given = read(fields, cls.entry, names={"frame": model.frame_names}, rows=lambda _: 1)
        return cls(
            given.name,
            model,
            given.frame,
            given.stiffness,
            given.damping,
            given.distance,
            given.near,
            given.far,
            given.radius,
            given.reference,
        )

    @property
    def reference_size(self) -> int:
        """The position of the obstacle has three entries, the task one row."""
        return len(WORLD_AXES)

    def default_target(self, model: RobotModel) -> TaskTarget:
        """The configured position of the obstacle; without one, far above the frame."""
        return self._reference or self.static_target(self.current(model))

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """One row along the line from the obstacle to the frame."""
        frame = model.frame(self._frame_id)
        away = frame.position - reference.position
        length = max(float(np.linalg.norm(away)), _CLOSEST)
        n, d = away / length, length - self.radius
        approach = frame.velocity[:3] - reference.velocity
        rate = float(n @ approach)
        turning = (float(approach @ approach) - rate * rate) / length
        h, _, _ = minimum_jerk((self.far - d) / (self.far - self.near))
        out.error[0] = self.distance - d
        out.jacobian[0] = n @ frame.jacobian[:3]
        out.drift[0] = float(n @ frame.drift[:3])
        out.velocity[0] = h * float(n @ reference.velocity)
        out.acceleration[0] = h * (float(n @ reference.acceleration) - turning)
        out.stiffness[0] = h * self.stiffness[0]

    def current(self, model: RobotModel) -> Array:
        """Position of an obstacle that is far away, (3,) [m]: the frame has none of its own."""
        position: Array = model.frame_position(self._frame_id) + [0.0, 0.0, _ABSENT]
        return position

    def gap(self, model: RobotModel, target: TaskTarget) -> float:
        """Distance d [m] at the last update of the model."""
        away = model.frame_position(self._frame_id) - target.position
        return float(np.linalg.norm(away)) - self.radius

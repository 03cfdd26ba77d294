"""A maximum speed of the origin of a frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from ghc_controller.constraints.constraint import (
    Constraint,
    Rows,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.constraints.registry import ConstraintFields, register_constraint
from ghc_controller.constraints.rows.distance import Scalar, rate_rows
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read

_AT_REST = 1e-9  # [m/s], [rad/s] below it a motion has no direction


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameSpeedFields(ConstraintFields):
    """Fields of the kind `frame_speed`."""

    frame: str = declared("frame of the URDF", names="frame")
    limit: float = declared("of its origin", unit="m/s", domain=POSITIVE)
    horizon: float = declared("over which it is approached", 0.05, unit="s", domain=POSITIVE)


@register_constraint("frame_speed")
class FrameSpeed(Constraint):
    """|p'| <= limit for the origin p of a frame, a row along its direction of motion."""

    entry: ClassVar[type[FrameSpeedFields]] = FrameSpeedFields
    space = Space.ACCELERATION
    softness = Softness.SOFT
    coordinates: ClassVar[slice] = slice(3)  # of the frame's velocity: those of its origin

    def __init__(self, name: str, frame_id: int, limit: float, horizon: float = 0.05) -> None:
        """Frame by `RobotModel.frame_id`, limit [m/s] or [rad/s], horizon [s].

        Raises:
            InvalidValue: a limit or horizon that is not above 0.
        """
        super().__init__(name)
        self._frame = frame_id
        self.limit = float(positive_per_joint(limit, 1, f"{name}, limit")[0])
        self.horizon = float(positive_per_joint(horizon, 1, f"{name}, horizon")[0])

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> Self:
        """Build from one entry of `constraints` in robot.yaml."""
        given = read(fields, cls.entry, names={"frame": model.frame_names})
        return cls(given.name, model.frame_id(given.frame), given.limit, given.horizon)

    def rows(self, tick: Tick) -> Rows:
        """With n = p' / |p'|: |p'|' = n . (J x + drift)."""
        frame = tick.model.frame(self._frame)
        velocity = frame.velocity[self.coordinates]
        speed = float(np.linalg.norm(velocity))
        n = velocity / speed if speed > _AT_REST else np.array([1.0, 0.0, 0.0])
        jacobian, drift = frame.jacobian[self.coordinates], frame.drift[self.coordinates]
        along = Scalar(np.nan, speed, n @ jacobian, float(n @ drift))
        return rate_rows(along, self.limit, self.horizon, tick, self.name)

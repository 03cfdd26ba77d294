"""A wall: the origin of a frame keeps on one side of a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.constraints.constraint import Tick
from ghc_controller.constraints.registry import ConstraintFields, register_constraint
from ghc_controller.constraints.rows.distance import DistanceConstraint, Scalar
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.types import Array

_Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class CartesianWallFields(ConstraintFields):
    """Fields of the kind `cartesian_wall`."""

    frame: str = declared("frame of the URDF", names="frame")
    point: _Vector = declared("of the plane, in the world", unit="m")
    normal: _Vector = declared("towards the side that is free, world axes", unit="-")
    distance: float = declared("least one to the plane", 0.0, unit="m", domain=NOT_NEGATIVE)
    brake: float = declared("deceleration before it", 2.0, unit="m/s^2", domain=POSITIVE)


@register_constraint("cartesian_wall")
class CartesianWall(DistanceConstraint):
    """normal . (p - point) >= distance for the origin p of a frame."""

    entry = CartesianWallFields

    def __init__(
        self,
        name: str,
        frame_id: int,
        point: Array,
        normal: Array,
        distance: float = 0.0,
        brake: float = 2.0,
    ) -> None:
        """Frame by `RobotModel.frame_id`; point and normal (3,) in the world [m].

        Raises:
            InvalidValue: a normal without a direction, or a number out of range.
        """
        super().__init__(name, distance, np.inf, brake)
        length = float(np.linalg.norm(normal))
        if not length > 1e-6:
            raise InvalidValue(f"{name}: normal {normal.tolist()} given, a direction expected")
        self._frame, self._point, self._normal = frame_id, point, normal / length

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> CartesianWall:
        """Build from one entry of `constraints` in robot.yaml."""
        given = read(fields, CartesianWallFields, names={"frame": model.frame_names})
        point, normal = np.array(given.point), np.array(given.normal)
        frame = model.frame_id(given.frame)
        return cls(given.name, frame, point, normal, given.distance, given.brake)

    def measure(self, tick: Tick) -> Scalar:
        """Distance to the plane [m]."""
        frame, n = tick.model.frame(self._frame), self._normal
        return Scalar(
            float(n @ (frame.position - self._point)),
            float(n @ frame.velocity[:3]),
            n @ frame.jacobian[:3],
            float(n @ frame.drift[:3]),
        )

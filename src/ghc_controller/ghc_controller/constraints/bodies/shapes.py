"""Shapes of bodies as robot.yaml states them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ghc_controller.errors import InvalidField
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeFields:
    """A sphere (at), a capsule (from, to) or a box (at, size), thickened by its radius."""

    at: Vector | None = declared("center of a sphere or box", None, unit="m")
    start: Vector | None = declared("first end of a capsule's axis", None, unit="m", name="from")
    end: Vector | None = declared("its other end", None, unit="m", name="to")
    size: Vector | None = declared("edges of a box", None, unit="m")
    rpy: Vector = declared("roll, pitch and yaw of a box", (0.0, 0.0, 0.0), unit="rad")
    radius: float = declared(
        "of a sphere or capsule; of the edges of a box", 0.0, unit="m", domain=NOT_NEGATIVE
    )

    def __post_init__(self) -> None:
        """Raise InvalidField for what is none of the three."""
        if (self.at is None) == (self.start is None):
            raise InvalidField("at", "'at' (sphere, box) or 'from' and 'to' (capsule) expected")
        if (self.start is None) != (self.end is None):
            raise InvalidField("to", "a capsule needs both 'from' and 'to'")
        if self.size is None and not self.radius > 0.0:
            raise InvalidField("radius", f"{self.radius:g} given, more than 0 expected")
        if self.size is not None and (self.at is None or not min(self.size) > 0.0):
            raise InvalidField("size", "'at' and three positive edges expected of a box")

    @property
    def shape(self) -> Shape:
        """The shape itself."""
        if self.at is None:
            start, end = np.array(self.start), np.array(self.end)
            return Shape.capsule(start, end, self.radius)
        if self.size is None:
            return Shape(np.array(self.at), np.zeros((3, 0)), self.radius)
        rotation = np.asarray(pin.rpy.rpyToMatrix(np.array(self.rpy)))
        return Shape.box(np.array(self.at), np.array(self.size), rotation, self.radius)


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyFields(ShapeFields):
    """A shape on a link of the robot."""

    frame: str = declared("link of the URDF that it is fixed to", names="frame")

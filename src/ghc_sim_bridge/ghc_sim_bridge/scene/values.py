"""What a scene adds to a robot: declared values of environment, contacts, obstacles, a camera."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ghc_controller.errors import InvalidField
from ghc_controller.robot.robot import Robot
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, SHARE, OneOf, Range
from ghc_controller.schema.reader import Fields
from ghc_controller.types import UNIT_TOLERANCE

Vector = tuple[float, float, float]
Colour = tuple[float, float, float, float]
Limit = float | Mapping[str, float] | None

SURFACE_KINDS = ("plane", "box")
_ORIGIN = (0.0, 0.0, 0.0)


def unit_vector(field: str, vector: Vector) -> Vector:
    """The vector at length 1; InvalidField for one that is not of that length."""
    length = math.hypot(*vector)
    if abs(length - 1.0) > UNIT_TOLERANCE:
        raise InvalidField(field, f"length 1 expected, {length:g} given")
    x, y, z = vector
    return (x / length, y / length, z / length)


@dataclass(frozen=True)
class BaseStart:
    """Where a floating base starts: frames of the robot that lie flat on something."""

    stand_on: tuple[str, ...] = declared(
        "frames of the URDF; z of the first one points up, unless `level` names another",
        names="frame",
        of="frames",
        empty=False,
    )
    at: Vector = declared("mean of their origins, world", _ORIGIN, unit="m")
    heading: float = declared(
        "about z, of the x axis of the level frame; 0 = along +x", 0.0, unit="deg"
    )
    level: str = declared(
        "frame of the URDF whose z axis points up; empty = the first of stand_on",
        "",
        names="frame",
    )

    @property
    def frames(self) -> tuple[str, ...]:
        """All frames whose places are needed, the level one first."""
        return tuple(dict.fromkeys((self.level or self.stand_on[0], *self.stand_on)))


def _size(fields: Fields, name: str) -> Vector:
    """Needed for everything but a plane."""
    if not fields.has(name) and fields.value("kind") == "plane":
        return _ORIGIN
    x, y, z = fields.vector(name, 3)
    return x, y, z


@dataclass(frozen=True)
class Surface:
    """A body of the environment that does not move; its top is horizontal."""

    name: str = declared("name of the surface")
    kind: str = declared("plane or box", domain=OneOf(SURFACE_KINDS))
    top: Vector = declared("center of the top face, world", _ORIGIN, unit="m")
    size: Vector = declared(
        "full lengths of a box; of a plane, for the picture only, 0 = without end",
        _ORIGIN,
        unit="m",
        read=_size,
    )
    colour: Colour = declared(
        "red, green, blue, opacity", (0.8, 0.8, 0.8, 1.0), unit="-", domain=SHARE
    )
    touches: bool = declared("whether contacts feel it, or it is there for the picture only", True)

    def __post_init__(self) -> None:
        """Raise InvalidField for a box without volume."""
        if self.kind != "plane" and min(self.size) <= 0.0:
            raise InvalidField("size", f"lengths above 0 expected, {self.size} given")


@dataclass(frozen=True)
class Contact:
    """Where the robot may touch the environment: balls at the points of a contact of its file."""

    name: str = declared("of a contact of robot.yaml, which says frame and points")
    radius: float = declared("of a ball at each point", unit="m", domain=Range(minimum=1e-4))
    inward: Vector | None = declared(
        "unit, in the frame, from a point into the body: the balls' surfaces are at the points; "
        "left out = their centers are",
        None,
        unit="-",
    )
    friction: float = declared(
        "sliding friction coefficient; 0 = frictionless", 0.5, unit="-", domain=NOT_NEGATIVE
    )
    time_constant: float = declared(
        "of the constraint's penetration; smaller is stiffer",
        0.005,
        unit="s",
        domain=Range(minimum=1e-4),
    )
    damping_ratio: float = declared("of the penetration", 1.0, unit="-", domain=NOT_NEGATIVE)
    frame: str = ""  # the last two come from robot.yaml
    centers: tuple[Vector, ...] = ()  # [m] of the balls, in the frame

    def __post_init__(self) -> None:
        """Normalize `inward`; raise InvalidField for no unit vector."""
        if self.inward is not None:
            object.__setattr__(self, "inward", unit_vector("inward", self.inward))

    def at(self, frame: str, points: Sequence[Vector]) -> Contact:
        """The contact with frame and points (p, 3) [m] of the robot's file."""
        x, y, z = (0.0, 0.0, 0.0) if self.inward is None else self.inward
        r = self.radius
        centers = tuple((a + r * x, b + r * y, c + r * z) for a, b, c in points)
        return replace(self, frame=frame, centers=centers)


@dataclass(frozen=True)
class Camera:
    """A picture's point of view: on a sphere about the point it looks at."""

    look_at: Vector = declared("point looked at, world", unit="m")
    distance: float = declared("from it", unit="m", domain=Range(minimum=0.01))
    azimuth: float = declared("about z; 0 looks along +x", unit="deg")
    elevation: float = declared("negative looks down", unit="deg")
    field_of_view: float = declared("vertical", 35.0, unit="deg", domain=Range(minimum=1.0))


@dataclass(frozen=True)
class Sighting:
    """Where an obstacle is from one time on."""

    time: float = declared("simulated", unit="s", domain=NOT_NEGATIVE)
    position: Vector | None = declared(
        "world, the point closest to the robot; left out = not seen", None, unit="m"
    )


@dataclass(frozen=True)
class Obstacle:
    """Something that comes near one frame of the robot, in jumps."""

    id: str = declared("name of the obstacle")
    protected_frame: str = declared("frame of the URDF", names="frame")
    safe_distance: float = declared("to be kept", unit="m", domain=NOT_NEGATIVE)
    normal: Vector | None = declared(
        "unit, to the frame: a plane through the positions; left out = a point",
        unit="-",
        fallback=None,
    )
    track: tuple[Sighting, ...] = declared(
        "increasing times; not seen before the first one", empty=False
    )

    def __post_init__(self) -> None:
        """Normalize the normal; raise InvalidField for no unit vector and times that fall."""
        if self.normal is not None:
            object.__setattr__(self, "normal", unit_vector("normal", self.normal))
        for before, after in zip(self.track, self.track[1:], strict=False):
            if after.time <= before.time:
                raise InvalidField(
                    "track",
                    f"increasing times expected, {after.time:g} s given after {before.time:g} s",
                )


@dataclass(frozen=True)
class SensorSettings:
    """The sensor that sees the obstacles."""

    period: float = declared(
        "between two messages, a multiple of the control period",
        0.1,
        unit="s",
        domain=Range(minimum=1e-3),
    )


@dataclass(frozen=True)
class SceneFields:
    """Content of a scene file, before its robot is read."""

    robot_name: str = declared(
        "name of a robot, or path; with a dot first, relative to this file", name="robot"
    )
    start: Mapping[str, float] = declared(
        "joint: position; joints left out start at 0", unit="rad"
    )
    camera: Camera = declared("point of view of pictures")
    name: str = declared("name of the scene; empty = that of the file", "")
    base: BaseStart | None = declared(
        "where a floating base starts; given for a robot that has one, and for no other", None
    )
    torque_limit: Limit = declared(
        "of the simulated motors: a number, or joint: number; left out = as in robot.yaml",
        None,
        unit="Nm",
    )
    gravity: Vector = declared("acceleration, world", (0.0, 0.0, -9.81), unit="m/s^2")
    surfaces: tuple[Surface, ...] = declared("what does not move", ())
    contacts: tuple[Contact, ...] = declared("where the robot may touch", ())
    obstacles: tuple[Obstacle, ...] = declared("what comes near", ())
    obstacle_sensor: SensorSettings | None = declared("needed with obstacles", None)
    end_stops: bool = declared("joints stop at their position limits", True)

    def __post_init__(self) -> None:
        """Raise InvalidField for names given twice and obstacles that no sensor would see."""
        lists: dict[str, list[Any]] = {
            "surfaces": [surface.name for surface in self.surfaces],
            "contacts": [contact.name for contact in self.contacts],
            "obstacles": [obstacle.id for obstacle in self.obstacles],
        }
        for what, given in lists.items():
            if len(set(given)) < len(given):
                raise InvalidField(what, f"names must differ, {given} given")
        if self.obstacles and self.obstacle_sensor is None:
            raise InvalidField("obstacle_sensor", "missing: nothing sees the obstacles")

    @property
    def sensor_period(self) -> float | None:
        """Period of the obstacle sensor [s]; None = there is none."""
        return None if self.obstacle_sensor is None else self.obstacle_sensor.period


@dataclass(frozen=True, kw_only=True)
class SceneDescription(SceneFields):
    """A scene file and the robot in it, checked: contacts have the places of the robot's file."""

    file: Path
    robot: Robot

    @property
    def urdf(self) -> Path:
        """Model file of the robot."""
        return self.robot.urdf

    @property
    def robot_file(self) -> Path:
        """File of the robot."""
        return self.robot.path

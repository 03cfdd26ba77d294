"""What a scene adds to a robot, as frozen values: surroundings, contacts, obstacles, a camera."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

Vector = tuple[float, float, float]
Colour = tuple[float, float, float, float]
Limit = float | Mapping[str, float] | None

SURFACE_KINDS = ("plane", "box")


@dataclass(frozen=True)
class BaseStart:
    """Where a floating base starts: frames of the robot that lie flat on something."""

    stand_on: tuple[str, ...]  # frames of the URDF; z of the first one points up
    at: Vector  # [m] mean of their origins, world
    heading: float  # [deg] about z, of the x axis of the first one; 0 = along +x


@dataclass(frozen=True)
class Surface:
    """A body of the surroundings that does not move; its top is horizontal."""

    name: str
    kind: str  # one of SURFACE_KINDS
    top: Vector  # [m] centre of the top face, world
    size: Vector  # [m] full lengths; of a plane, for the picture only, 0 = without end
    colour: Colour
    touches: bool  # whether contacts feel it, or it is there for the picture only


@dataclass(frozen=True)
class Contact:
    """Where the robot may touch the surroundings: spheres fixed to one of its frames."""

    name: str
    frame: str
    radius: float  # [m]
    points: tuple[Vector, ...]  # [m] centres of the spheres in the frame
    friction: float  # sliding friction coefficient; 0 = frictionless
    time_constant: float  # [s] of the constraint's penetration; smaller is stiffer
    damping_ratio: float


@dataclass(frozen=True)
class Camera:
    """A picture's point of view: on a sphere about the point it looks at."""

    look_at: Vector  # [m] world
    distance: float  # [m]
    azimuth: float  # [deg] about z; 0 looks along +x
    elevation: float  # [deg] negative looks down
    field_of_view: float  # [deg] vertical


@dataclass(frozen=True)
class Sighting:
    """Where an obstacle is from one time on."""

    time: float  # [s] simulated
    position: Vector | None  # [m] world, the point closest to the robot; None = not seen


@dataclass(frozen=True)
class Obstacle:
    """Something that comes near one frame of the robot, in jumps."""

    id: str
    protected_frame: str
    safe_distance: float  # [m] to be kept
    normal: Vector | None  # unit, to the frame: a plane through the positions; None = a point
    track: tuple[Sighting, ...]  # increasing times; not seen before the first one


@dataclass(frozen=True)
class SceneDescription:
    """One scene file, checked."""

    name: str
    file: Path
    robot_file: Path
    urdf: Path
    start: Mapping[str, float]  # joint -> [rad]
    base: BaseStart | None  # None = the robot's base is fixed
    torque_limit: Limit  # [Nm] of scene or robot.yaml; one number, by joint, None = the URDF's
    velocity_limit: Limit  # [rad/s] likewise
    gravity: Vector  # [m/s^2]
    surfaces: tuple[Surface, ...]
    contacts: tuple[Contact, ...]
    camera: Camera
    obstacles: tuple[Obstacle, ...] = ()
    sensor_period: float | None = None  # [s] of the obstacle sensor; None = there is none
    end_stops: bool = True  # joints stop at their position limits

"""What a scene adds to a robot: where it starts, what stands around it, what touches, the camera.

A URDF says what the robot is; the rest stands in `scenes/<name>.yaml` and becomes the frozen
values below. Everything is checked here, with file and field in the message.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robots import find_robot
from ghc_sim_bridge.yaml_fields import Fields, read_yaml

Vector = tuple[float, float, float]
Colour = tuple[float, float, float, float]

SURFACE_KINDS = ("plane", "box")


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
class SceneDescription:
    """One scene file, checked."""

    name: str
    file: Path
    robot_file: Path
    urdf: Path
    start: Mapping[str, float]  # joint -> [rad]
    gravity: Vector  # [m/s^2]
    surfaces: tuple[Surface, ...]
    contacts: tuple[Contact, ...]
    camera: Camera


def list_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with the package."""
    return tuple(sorted(entry.stem for entry in _scene_folder().glob("*.yaml")))


def find_scene(scene: str | Path) -> Path:
    """Path of a scene file, given a name of `list_scenes()` or a path.

    Raises UnknownName (listing the scenes) or ConfigurationError when there is none.
    """
    text = str(scene)
    if isinstance(scene, Path) or "/" in text or text.endswith((".yaml", ".yml")):
        path = Path(text).expanduser()
        if not path.is_file():
            raise ConfigurationError(
                f"scene file '{path}' does not exist; give the path of a scene file or one of: "
                + ", ".join(list_scenes())
            )
        return path.resolve()
    if text not in list_scenes():
        raise UnknownName("scene", text, list_scenes())
    return _scene_folder() / f"{text}.yaml"


def load_scene(scene: str | Path) -> SceneDescription:
    """Read and check a scene, given its name or path.

    Raises UnknownName or ConfigurationError, naming file and field.
    """
    file = find_scene(scene)
    fields = Fields(read_yaml(file), file)
    robot_file, urdf = _robot(fields)
    start = fields.section("start")
    description = SceneDescription(
        name=fields.text("name", file.stem),
        file=file,
        robot_file=robot_file,
        urdf=urdf,
        start={joint: start.number(joint) for joint in start.names()},
        gravity=_vector(fields, "gravity", (0.0, 0.0, -9.81)),
        surfaces=tuple(_surface(entry) for entry in fields.items("surfaces", ())),
        contacts=tuple(_contact(entry) for entry in fields.items("contacts", ())),
        camera=_camera(fields.section("camera")),
    )
    fields.close()
    for what, entries in (
        ("surfaces", [surface.name for surface in description.surfaces]),
        ("contacts", [contact.name for contact in description.contacts]),
    ):
        if len(set(entries)) < len(entries):
            raise fields.error(what, f"names must differ, given: {', '.join(entries)}")
    return description


def _scene_folder() -> Path:
    return Path(str(files("ghc_sim_bridge"))) / "scenes"


def _robot(fields: Fields) -> tuple[Path, Path]:
    name = fields.text("robot")
    try:
        robot_file = find_robot(fields.file.parent / name if name.startswith(".") else name)
    except (UnknownName, ConfigurationError) as error:
        raise fields.error("robot", str(error)) from error
    robot = Fields(read_yaml(robot_file), robot_file)
    if robot.value("floating_base", False) is not False:
        raise robot.error("floating_base", "the simulator knows robots with a fixed base only")
    urdf = robot_file.parent / robot.text("urdf")
    if not urdf.is_file():
        raise robot.error("urdf", f"'{urdf}' does not exist")
    return robot_file, urdf


def _surface(fields: Fields) -> Surface:
    kind = fields.text("kind")
    if kind not in SURFACE_KINDS:
        raise fields.error("kind", f"'{kind}' given, one of {', '.join(SURFACE_KINDS)} expected")
    plane = kind == "plane"
    touches = fields.value("touches", True)
    if not isinstance(touches, bool):
        raise fields.error("touches", f"true or false is expected, {touches!r} given")
    surface = Surface(
        name=fields.text("name"),
        kind=kind,
        top=_vector(fields, "top", (0.0, 0.0, 0.0)),
        size=_vector(fields, "size", (0.0, 0.0, 0.0) if plane else None),
        colour=_colour(fields, "colour", (0.8, 0.8, 0.8, 1.0)),
        touches=touches,
    )
    fields.close()
    if not plane and min(surface.size) <= 0.0:
        raise fields.error("size", f"lengths above 0 are expected, {surface.size} given")
    return surface


def _contact(fields: Fields) -> Contact:
    points = fields.value("points", [[0.0, 0.0, 0.0]])
    if not isinstance(points, list) or not points:
        raise fields.error("points", f"a list of points is expected, {points!r} given")
    centres = Fields({str(k): point for k, point in enumerate(points)}, fields.file,
                     f"{fields.where}.points")
    contact = Contact(
        name=fields.text("name"),
        frame=fields.text("frame"),
        radius=fields.number("radius", minimum=1e-4),
        points=tuple(_vector(centres, str(k)) for k in range(len(points))),
        friction=fields.number("friction", 0.5, minimum=0.0),
        time_constant=fields.number("time_constant", 0.005, minimum=1e-4),
        damping_ratio=fields.number("damping_ratio", 1.0, minimum=0.0),
    )
    fields.close()
    return contact


def _camera(fields: Fields) -> Camera:
    camera = Camera(
        look_at=_vector(fields, "look_at"),
        distance=fields.number("distance", minimum=0.01),
        azimuth=fields.number("azimuth"),
        elevation=fields.number("elevation"),
        field_of_view=fields.number("field_of_view", 35.0, minimum=1.0),
    )
    fields.close()
    return camera


def _vector(fields: Fields, name: str, default: Vector | None = None) -> Vector:
    values = fields.vector(name) if default is None else fields.vector(name, default)
    if len(values) != 3:
        raise fields.error(name, f"3 numbers are expected, {len(values)} given")
    return values[0], values[1], values[2]


def _colour(fields: Fields, name: str, default: Colour) -> Colour:
    values = fields.vector(name, default)
    if len(values) != 4 or not all(math.isfinite(x) and 0.0 <= x <= 1.0 for x in values):
        raise fields.error(name, f"4 numbers of [0, 1] are expected, {values} given")
    return values[0], values[1], values[2], values[3]

"""Scene files: a URDF says what the robot is, `scene/data/<name>.yaml` says the rest.

Where the robot starts, what stands around it, what may touch, and the point of view of pictures.
Everything is checked here, with file and field in the message.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.registry import Registry
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.schema.plugged_files import Files, plugged_file
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_sim_bridge.scene.fields import (
    read_base,
    read_camera,
    read_contact,
    read_surface,
    read_vector,
)
from ghc_sim_bridge.scene.obstacle_fields import read_obstacle, read_sensor_period
from ghc_sim_bridge.scene.values import (
    BaseStart,
    Camera,
    Contact,
    Obstacle,
    SceneDescription,
    Surface,
)

__all__ = [
    "SCENES",
    "Camera",
    "Contact",
    "Obstacle",
    "SceneDescription",
    "Surface",
    "find_scene",
    "list_scenes",
    "load_scene",
]


SCENES: Registry[Files] = Registry("scene", "ghc_sim_bridge.scenes")
for _file in sorted((Path(str(files("ghc_sim_bridge"))) / "scene" / "data").glob("*.yaml")):
    SCENES.register(_file.stem)(_file)


def list_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with this and other packages, sorted."""
    return tuple(SCENES)


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
    return plugged_file(SCENES[text], f"{text}.yaml")


def load_scene(scene: str | Path) -> SceneDescription:
    """Read and check a scene, given its name or path.

    Raises UnknownName or ConfigurationError, naming file and field.
    """
    file = find_scene(scene)
    fields = read_yaml(file)
    robot_file, robot, urdf = _robot(fields, file)
    limits = robot.section("limits", optional=True)
    start = fields.section("start")
    description = SceneDescription(
        name=fields.text("name", file.stem),
        file=file,
        robot_file=robot_file,
        urdf=urdf,
        start={joint: start.number(joint) for joint in start.given()},
        base=_base(fields, robot),
        torque_limit=(
            fields.number_or_map("torque_limit")
            if fields.has("torque_limit")
            else limits.number_or_map("torque")
        ),
        velocity_limit=limits.number_or_map("velocity"),
        gravity=read_vector(fields, "gravity", (0.0, 0.0, -9.81)),
        surfaces=tuple(
            read_surface(entry) for entry in fields.sections("surfaces", optional=True)
        ),
        contacts=tuple(
            read_contact(entry) for entry in fields.sections("contacts", optional=True)
        ),
        camera=read_camera(fields.section("camera")),
        obstacles=tuple(
            read_obstacle(entry) for entry in fields.sections("obstacles", optional=True)
        ),
        sensor_period=read_sensor_period(fields),
        end_stops=fields.flag("end_stops", True),
    )
    fields.done()
    for what, entries in (
        ("surfaces", [surface.name for surface in description.surfaces]),
        ("contacts", [contact.name for contact in description.contacts]),
        ("obstacles", [obstacle.id for obstacle in description.obstacles]),
    ):
        if len(set(entries)) < len(entries):
            raise fields.error(what, f"names must differ, {entries} given")
    return description


def _robot(fields: Fields, file: Path) -> tuple[Path, Fields, Path]:
    """File and fields of the robot.yaml, and the URDF that it names."""
    name = fields.text("robot")
    try:
        robot_file = find_robot(file.parent / name if name.startswith(".") else name)
    except (UnknownName, ConfigurationError) as error:
        raise fields.error("robot", str(error)) from error
    robot = read_yaml(robot_file)
    urdf = find_urdf(robot.value("urdf"), robot_file)
    if not urdf.is_file():
        raise robot.error("urdf", f"'{urdf}' does not exist")
    return robot_file, robot, urdf


def _base(fields: Fields, robot: Fields) -> BaseStart | None:
    """Where the base starts; given for a robot with a floating base, and for no other."""
    if robot.flag("floating_base", False):
        return read_base(fields.section("base"))
    if fields.has("base"):
        raise fields.error("base", "the robot's base is fixed, it has no start of its own")
    return None

"""Scene files: a URDF says what the robot is, `scene/data/<name>.yaml` says the rest.

Where the robot starts, what stands around it, what may touch, and the point of view of pictures.
Everything is checked here, with file and field in the message.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.registry import Registry
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.schema.plugged_files import Files, plugged_file
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read
from ghc_sim_bridge.scene.values import (
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
    given = read(fields, SceneDescription)
    robot_file, robot, urdf = _robot(given.robot, fields, file)
    _check_base(fields, robot)
    limits = robot.section("limits", optional=True)
    torque = limits.number_or_map("torque") if given.torque_limit is None else given.torque_limit
    return replace(
        given,
        name=given.name or file.stem,
        file=file,
        robot_file=robot_file,
        urdf=urdf,
        torque_limit=torque,
        velocity_limit=limits.number_or_map("velocity"),
    )


def _robot(name: str, fields: Fields, file: Path) -> tuple[Path, Fields, Path]:
    """File and fields of the robot.yaml, and the URDF that it names."""
    try:
        robot_file = find_robot(file.parent / name if name.startswith(".") else name)
    except (UnknownName, ConfigurationError) as error:
        raise fields.error("robot", str(error)) from error
    robot = read_yaml(robot_file)
    urdf = find_urdf(robot.value("urdf"), robot_file)
    if not urdf.is_file():
        raise robot.error("urdf", f"'{urdf}' does not exist")
    return robot_file, robot, urdf


def _check_base(fields: Fields, robot: Fields) -> None:
    """`base` is given for a robot with a floating base, and for no other."""
    if robot.flag("floating_base", False):
        fields.value("base")
    elif fields.has("base"):
        raise fields.error("base", "the robot's base is fixed, it has no start of its own")

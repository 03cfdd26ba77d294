"""Scene files: a URDF says what the robot is, `scene/data/<name>.yaml` says the rest.

Where the robot starts, what stands around it, what may touch, and the point of view of pictures.
Everything is checked here, with file and field in the message.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields as dataclass_fields
from pathlib import Path

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.migration.names import Kind, hint
from ghc_controller.registry import Registry
from ghc_controller.robot.library import load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.schema.plugged_files import Files, plugged_file
from ghc_controller.schema.reader import Fields, read_yaml
from ghc_controller.schema.record import read
from ghc_sim_bridge.scene.values import (
    Camera,
    Contact,
    Obstacle,
    SceneDescription,
    SceneFields,
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
SCENES.register_files("ghc_sim_bridge", "scene/data/*.yaml")


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
    _refuse_places(fields)
    given = read(fields, SceneFields)
    robot = _robot(given.robot_name, fields, file)
    _check_base(fields, robot)
    values = {item.name: getattr(given, item.name) for item in dataclass_fields(given)}
    values["name"] = given.name or file.stem
    values["contacts"] = _placed(given.contacts, robot, fields)
    return SceneDescription(**values, file=file, robot=robot)


def _refuse_places(fields: Fields) -> None:
    """Frame and points of a contact stood here before."""
    for contact in fields.sections("contacts", optional=True):
        for name in ("frame", "points"):
            if contact.has(name):
                raise contact.error(name, hint(Kind.SCENE, f"contacts.{name}"))


def _robot(name: str, fields: Fields, file: Path) -> Robot:
    """The robot of that name, or of a path that may be relative to the scene."""
    try:
        return load_robot(file.parent / name if name.startswith(".") else name)
    except UnknownName as error:
        if error.kind != "robot":
            raise
        raise fields.error("robot", str(error)) from error


def _placed(contacts: Sequence[Contact], robot: Robot, fields: Fields) -> tuple[Contact, ...]:
    """The contacts with frame and points of the robot's file."""
    placed = []
    for contact, entry in zip(contacts, fields.sections("contacts", optional=True), strict=True):
        place = robot.contact_places.get(contact.name)
        if place is None:
            known = ", ".join(robot.contact_places) or "none"
            raise entry.error(
                "name",
                f"'{contact.name}' given, a contact of {robot.path} expected, which says its "
                f"frame and points; known: {known}",
            )
        placed.append(contact.at(place.frame, place.points))
    return tuple(placed)


def _check_base(fields: Fields, robot: Robot) -> None:
    """`base` is given for a robot with a floating base, and for no other."""
    if robot.floating_base:
        fields.value("base")
    elif fields.has("base"):
        raise fields.error("base", "the robot's base is fixed, it has no start of its own")

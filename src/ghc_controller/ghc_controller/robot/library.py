"""Robots as data: each folder holds a URDF, the robot.yaml beside it and where they come from."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robot.robot import Robot, load_robot_config

ROBOT_FILE = "robot.yaml"
_DATA = Path(str(files("ghc_controller"))) / "robot" / "data"


def list_robots() -> tuple[str, ...]:
    """Names of the robots that come with the package."""
    return tuple(sorted(entry.parent.name for entry in _DATA.glob(f"*/{ROBOT_FILE}")))


def find_robot(robot: str | Path) -> Path:
    """Path of the robot.yaml of a robot.

    Args:
        robot: name of a robot of this package, or the path of a robot.yaml or of its folder.

    Raises:
        UnknownName: no robot of that name; lists the ones that exist.
        ConfigurationError: a path was given and there is no robot.yaml.
    """
    text = str(robot)
    if isinstance(robot, Path) or "/" in text or text.endswith((".yaml", ".yml")):
        return _at_path(Path(text).expanduser())
    if text not in list_robots():
        raise UnknownName("robot", text, list_robots())
    return _DATA / text / ROBOT_FILE


def load_robot(robot: str | Path) -> Robot:
    """Robot of that name, or of a robot.yaml or its folder; raises as `find_robot` does.

    Raises:
        ConfigurationError: the file is wrong: file, field, what was given and expected.
    """
    return load_robot_config(find_robot(robot))


def _at_path(path: Path) -> Path:
    found = path / ROBOT_FILE if path.is_dir() else path
    if not found.is_file():
        raise ConfigurationError(
            f"robot file '{found}' does not exist; give the path of a {ROBOT_FILE} or one of: "
            + ", ".join(list_robots())
        )
    return found.resolve()

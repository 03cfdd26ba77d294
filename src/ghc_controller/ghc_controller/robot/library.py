"""Robots by name: folders with a URDF and its robot.yaml, or plug-ins."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ghc_controller.errors import ConfigurationError, PluginError
from ghc_controller.registry import Registry
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.schema.plugged_files import Files, made, plugged_file

ROBOT_FILE = "robot.yaml"

# A robot.yaml as `plugged_file` finds it, or a function that returns a Robot.
RobotSource = Files | Callable[[], Robot]

ROBOTS: Registry[RobotSource] = Registry("robot", "ghc_controller.robots")
ROBOTS.register_files("ghc_controller", f"robot/data/*/{ROBOT_FILE}")


def list_robots() -> tuple[str, ...]:
    """Names of the robots that come with this and other packages, sorted."""
    return tuple(ROBOTS)


def find_robot(robot: str | Path) -> Path:
    """Path of the robot.yaml of a robot.

    Args:
        robot: name of a robot, or the path of a robot.yaml or of its folder.

    Raises:
        UnknownName: no robot of that name; lists the ones that exist.
        ConfigurationError: there is no robot.yaml at the path, or the robot of that name is
            written in Python and has none.
    """
    found = _find(robot)
    if isinstance(found, Robot):
        raise ConfigurationError(
            f"robot '{robot}' is written in Python: it has no {ROBOT_FILE}, which simulator and "
            "scenarios read"
        )
    return found


def load_robot(robot: str | Path) -> Robot:
    """Robot of that name, or of a robot.yaml or its folder.

    Raises:
        UnknownName: no robot of that name; lists the ones that exist.
        ConfigurationError: there is no such file, or it is wrong: file, field, what was given and
            expected.
    """
    found = _find(robot)
    return found if isinstance(found, Robot) else load_robot_config(found)


def given_robot(given: object) -> Robot:
    """A robot as it was given.

    Raises:
        ConfigurationError: something else was.
    """
    if isinstance(given, Robot):
        return given
    raise ConfigurationError(
        f"{_brief(given)} given, a Robot expected: load_robot makes one of a name or path, "
        "Controller.for_robot the controller as well"
    )


def _brief(given: object) -> str:
    """A text itself, the type of anything else."""
    return f"'{given}'" if isinstance(given, str | Path) else f"a {type(given).__name__}"


def _find(robot: object) -> Path | Robot:
    """File of a robot, or the robot itself where a package writes it in Python."""
    if not isinstance(robot, str | Path):
        raise ConfigurationError(
            f"{_brief(robot)} given, the name of a robot or a path expected"
            + ("; Controller(robot) takes the robot itself" if isinstance(robot, Robot) else "")
        )
    text = str(robot)
    if isinstance(robot, Path) or "/" in text or text.endswith((".yaml", ".yml")):
        return _at_path(Path(text).expanduser())
    source = ROBOTS[text]
    try:
        found = made(source)
        return found if isinstance(found, Robot) else plugged_file(found, ROBOT_FILE)
    except PluginError as error:
        raise PluginError(f"robot '{text}': {error}") from error


def _at_path(path: Path) -> Path:
    found = path / ROBOT_FILE if path.is_dir() else path
    if not found.is_file():
        raise ConfigurationError(
            f"robot file '{found}' does not exist; give the path of a {ROBOT_FILE} or one of: "
            + ", ".join(list_robots())
        )
    return found.resolve()

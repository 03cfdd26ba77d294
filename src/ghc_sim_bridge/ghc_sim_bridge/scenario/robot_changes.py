"""A robot's YAML with a scenario's changes merged in, written beside the results of the run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.schema.merging import merged
from ghc_controller.schema.reader import Fields, read_yaml


def write_changed_robot(source: Path, changes: Mapping[str, Any], target: Path) -> Path:
    """Write `source` with `changes` merged in to `target`, and return `target`.

    Mappings merge, null takes a field away; tasks and contacts are found by their name (a list of
    contacts stands in place of the robot's); the URDF becomes an absolute path. Raises UnknownName
    for a task or contact that the robot has not, ConfigurationError for anything malformed.
    """
    robot = _changed(source, changes)
    robot["urdf"] = str(find_urdf(robot.get("urdf"), source).resolve())
    target.write_text(yaml.safe_dump(robot, sort_keys=False), encoding="utf-8")
    return target


def names_of(kind: str, source: Path, changes: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the tasks or contacts (`kind`) that the robot of `source` has with `changes`.

    Raises as `write_changed_robot` does, but for the URDF, which is not looked for.
    """
    fields = Fields(_changed(source, changes), source)
    return tuple(entry.text("name") for entry in fields.sections(kind, optional=True))


def _changed(source: Path, changes: Mapping[str, Any]) -> dict[str, Any]:
    """What `source` holds, with `changes` merged in."""
    robot = read_yaml(source).values
    named = {key: value for key, value in changes.items() if _is_by_name(key, value)}
    result = merged(robot, {key: value for key, value in changes.items() if key not in named})
    for kind, by_name in named.items():
        result[kind] = _merge_named(source, kind, robot.get(kind, []), by_name)
    return result


def _is_by_name(key: str, value: object) -> bool:
    """A list of contacts stands in place of the robot's; a mapping changes those that it names."""
    return key == "tasks" or (key == "contacts" and isinstance(value, Mapping))


def _merge_named(
    source: Path, kind: str, entries: object, changes: object
) -> list[dict[str, Any]]:
    if not isinstance(entries, list) or not isinstance(changes, Mapping):
        raise ConfigurationError(
            f"{source}: {kind}: a list of {kind} and a mapping of changes by "
            f"name expected, {entries!r} and {changes!r} given"
        )
    names = [entry["name"] for entry in entries]
    for name in changes:
        if name not in names:
            raise UnknownName(f"{kind[:-1]} of {source}", str(name), names)
    return [merged(entry, changes.get(entry["name"], {})) for entry in entries]

"""Merges a scenario's changes into robot.yaml and writes it next to the results of the run."""

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
    """Write `source` merged with `changes` to `target`, and return `target`.

    Mappings merge, null removes a field; tasks and contacts are matched by name (a list of
    contacts replaces the robot's); the URDF becomes an absolute path. Raises UnknownName for a
    task or contact that the robot does not have, ConfigurationError for malformed input.
    """
    robot = _changed(source, changes)
    robot["urdf"] = str(find_urdf(robot.get("urdf"), source).resolve())
    target.write_text(yaml.safe_dump(robot, sort_keys=False), encoding="utf-8")
    return target


def names_of(kind: str, source: Path, changes: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the tasks or contacts (`kind`) of the robot of `source` with `changes`.

    Raises as `write_changed_robot`, except for a missing URDF.
    """
    fields = Fields(_changed(source, changes), source)
    return tuple(entry.text("name") for entry in fields.sections(kind, optional=True))


def _changed(source: Path, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Content of `source` merged with `changes`."""
    robot = read_yaml(source).values
    named = {key: value for key, value in changes.items() if _is_by_name(key, value)}
    result = merged(robot, {key: value for key, value in changes.items() if key not in named})
    for kind, by_name in named.items():
        result[kind] = _merge_named(source, kind, robot.get(kind, []), by_name)
    return result


def _is_by_name(key: str, value: object) -> bool:
    """Whether entries are matched by name; a list of contacts replaces the robot's instead."""
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

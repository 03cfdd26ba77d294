"""A robot's YAML with a scenario's changes merged in, written beside the results of the run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.urdf_source import find_urdf
from ghc_sim_bridge.yaml_fields import read_yaml


def write_changed_robot(source: Path, changes: Mapping[str, Any], target: Path) -> Path:
    """Write `source` with `changes` merged in to `target`, and return `target`.

    Mappings merge; tasks are found by their name; the URDF becomes an absolute path. Raises
    UnknownName for a task that the robot has not, ConfigurationError for anything malformed.
    """
    robot = read_yaml(source)
    merged = _merge(robot, {key: value for key, value in changes.items() if key != "tasks"})
    merged["tasks"] = _merge_tasks(source, robot.get("tasks", []), changes.get("tasks", {}))
    merged["urdf"] = str(find_urdf(merged.get("urdf"), source).resolve())
    target.write_text(yaml.safe_dump(merged, sort_keys=False), encoding="utf-8")
    return target


def _merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(base)
    for key, value in changes.items():
        known = result.get(key)
        both = isinstance(known, Mapping) and isinstance(value, Mapping)
        result[key] = _merge(known, value) if both else value  # type: ignore[arg-type]
    return result


def _merge_tasks(source: Path, tasks: object, changes: object) -> list[dict[str, Any]]:
    if not isinstance(tasks, list) or not isinstance(changes, Mapping):
        raise ConfigurationError(
            f"{source}: tasks: a list of tasks and a mapping of changes by "
            f"name are expected, {tasks!r} and {changes!r} given"
        )
    names = [task["name"] for task in tasks]
    for name in changes:
        if name not in names:
            raise UnknownName(f"task of {source}", str(name), names)
    return [_merge(task, changes.get(task["name"], {})) for task in tasks]

"""Task kinds by name."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from typing import TypeVar

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.task import Task, TaskFields

_kinds: dict[str, type[Task]] = {}
_T = TypeVar("_T", bound=type[Task])


def register_task(kind: str) -> Callable[[_T], _T]:
    """Class decorator that makes a Task subclass available as `kind` in robot.yaml."""

    def register(task_class: _T) -> _T:
        _kinds[kind] = task_class
        return task_class

    return register


def task_kinds() -> tuple[str, ...]:
    """Every kind, sorted. Imports all modules of this folder: a new file is enough to add one."""
    package = importlib.import_module("ghc_controller.tasks")
    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{package.__name__}.{module.name}")
    return tuple(sorted(_kinds))


def task_entries() -> dict[str, type[TaskFields]]:
    """Kind -> declared fields of its entry, sorted."""
    return {kind: _kinds[kind].entry for kind in task_kinds()}


def make_task(fields: Fields, model: RobotModel) -> Task:
    """Build the task that one entry of `tasks` in robot.yaml describes.

    Raises:
        ConfigurationError: unknown kind, or a field that is missing, unknown or out of range.
    """
    kind = fields.choice("kind", task_kinds())
    task = _kinds[kind].from_config(fields, model)
    fields.done()
    return task

"""Task kinds by name."""

from __future__ import annotations

from ghc_controller.errors import PluginError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.registry import Registry
from ghc_controller.schema.reader import Fields
from ghc_controller.tasks.task import Task, TaskFields

TASKS: Registry[type[Task]] = Registry(
    "task kind", "ghc_controller.tasks", modules="ghc_controller.tasks", base=Task
)
# Class decorator: makes a Task available as `kind` in robot.yaml.
register_task = TASKS.register


def task_entries() -> dict[str, type[TaskFields]]:
    """Kind -> declared fields of its entry, sorted; built-in kinds alone, as schemas have them."""
    return {kind: TASKS[kind].entry for kind in sorted(TASKS.built_in)}


def make_task(fields: Fields, model: RobotModel) -> Task:
    """Build the task that one entry of `tasks` in robot.yaml describes.

    Raises:
        ConfigurationError: unknown kind, or a field that is missing, unknown or out of range.
    """
    kind = fields.choice("kind", TASKS)
    try:
        task = TASKS[kind].from_config(fields, model)
    except PluginError as error:
        raise fields.error("kind", str(error)) from error
    fields.done()
    return task

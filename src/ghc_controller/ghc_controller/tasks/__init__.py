"""Tasks: one file per kind. `Task` defines the interface, `registry` finds the kinds."""

from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.tasks.registry import TASKS, make_task, register_task
from ghc_controller.tasks.task import Task

__all__ = ["TASKS", "ReferenceSpace", "Task", "make_task", "register_task"]

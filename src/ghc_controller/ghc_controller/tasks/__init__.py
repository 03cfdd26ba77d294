"""Tasks: one file a kind. `Task` says what a kind must implement, `registry` how it is found."""

from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.tasks.registry import TASKS, make_task, register_task, task_kinds
from ghc_controller.tasks.task import Task

__all__ = ["TASKS", "ReferenceSpace", "Task", "make_task", "register_task", "task_kinds"]

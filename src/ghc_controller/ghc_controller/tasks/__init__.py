"""Tasks: one file a kind. `Task` says what a kind must implement, `registry` how it is found."""

from ghc_controller.tasks.registry import make_task, register_task, task_kinds
from ghc_controller.tasks.task import ReferenceSpace, Task
from ghc_controller.tasks.task_stack import TaskStack

__all__ = ["ReferenceSpace", "Task", "TaskStack", "make_task", "register_task", "task_kinds"]

"""Tasks that the compiled core measures: all of a stack in one call, or one by itself."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from ghc_controller.core import Measure
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.tasks.task import Task
from ghc_controller.types import TaskRows, TaskTarget


class CompiledTask(Task):
    """A task with a measure of the core.

    A subclass that brings a `measure` of its own is measured by that, like any task in Python.
    """

    def __init__(
        self,
        name: str,
        labels: Sequence[str],
        stiffness: ArrayLike,
        damping: ArrayLike,
        core: Measure,
        reference: ArrayLike | None = None,
    ) -> None:
        """See Task; `core` has as many rows as there are labels."""
        super().__init__(name, labels, stiffness, damping, reference)
        self.core = core

    def measure(self, model: RobotModel, reference: TaskTarget, out: TaskRows) -> None:
        """See Task."""
        self.core.write(
            model.core,
            reference.position,
            out.error,
            out.drift,
            out.velocity,
            out.acceleration,
            out.jacobian,
        )


def measured_by_core(task: Task) -> Measure | None:
    """The measure of a task whose `measure` is that of the core."""
    if isinstance(task, CompiledTask) and type(task).measure is CompiledTask.measure:
        return task.core
    return None

"""State that a task accumulates over time, owned by the user of the task."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import RobotState, TaskRows, TaskTarget


class TaskMemory(ABC):
    """Memory of one task: an integrator, a filter, whether it is in contact.

    `Task.make_memory` makes it and `TaskStack` holds it, so that two controllers of one robot do
    not share it, and a task can be measured anywhere, any number of times.
    """

    @abstractmethod
    def reset(self) -> None:
        """Forget everything."""

    @abstractmethod
    def apply(
        self, model: RobotModel, state: RobotState, reference: TaskTarget, rows: TaskRows
    ) -> int:
        """Advance to `state.time` and change rows just measured there, before the law is applied.

        A state that comes twice must give the same rows twice.

        Returns:
            Number of rows under force control now.
        """

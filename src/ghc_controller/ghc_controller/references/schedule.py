"""Which reference each task follows at which time."""

from __future__ import annotations

from collections.abc import Sequence

from ghc_controller.errors import UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import Follower
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.types import TaskTarget


class ReferenceSchedule:
    """References by task; the one that started last is followed, later ones wait for their time.

    A task without a reference follows its configured one, or stays where it was at `begin`.
    """

    def __init__(self, tasks: Sequence[Follower]) -> None:
        self._tasks = tuple(tasks)
        self._index = {task.name: i for i, task in enumerate(self._tasks)}
        self.reset()

    def reset(self) -> None:
        """Forget every reference; `begin` must be called again."""
        self._queues: list[list[ReferenceTrajectory]] = [[] for _ in self._tasks]
        self._defaults: list[TaskTarget] = []
        self._begun = False

    def begin(self, model: RobotModel, stay: bool = False) -> None:
        """Fix the targets of tasks without a reference at the state of the last update.

        With `stay` also those whose robot's file gives a reference stay where they are.
        """
        self._defaults = [
            task.static_target(task.current(model)) if stay else task.default_target(model)
            for task in self._tasks
        ]
        self._begun = True

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tasks."""
        return tuple(self._index)

    @property
    def has_begun(self) -> bool:
        """True after `begin`."""
        return self._begun

    def task(self, name: str) -> Follower:
        """Task of that name.

        Raises:
            UnknownName: no such task; the message lists those that exist.
        """
        if name not in self._index:
            raise UnknownName("task", name, self._index)
        return self._tasks[self._index[name]]

    def add(self, reference: ReferenceTrajectory) -> None:
        """Take a reference; of two with the same start the newer one wins.

        Raises:
            UnknownName: it belongs to no task of the controller.
        """
        self.task(reference.task)
        queue = self._queues[self._index[reference.task]]
        queue.append(reference)
        queue.sort(key=lambda entry: entry.start_time)

    def current(self, name: str, time: float) -> TaskTarget:
        """Target of the task of that name at `time` [s]; UnknownName if there is none."""
        self.task(name)
        return self.target(self._index[name], time)

    def peek(self, name: str, time: float) -> TaskTarget:
        """As `current`, and the schedule is only read: for another thread."""
        self.task(name)
        index = self._index[name]
        begun = [entry for entry in tuple(self._queues[index]) if entry.start_time <= time]
        return begun[-1].target(time) if begun else self._defaults[index]

    def targets(self, time: float) -> list[TaskTarget]:
        """Targets of all tasks at `time` [s], in their order."""
        return [self.target(index, time) for index in range(len(self._tasks))]

    def target(self, index: int, time: float) -> TaskTarget:
        """Target of task number `index` at `time` [s]."""
        queue = self._queues[index]
        while len(queue) > 1 and queue[1].start_time <= time:
            queue.pop(0)
        if queue and queue[0].start_time <= time:
            return queue[0].target(time)
        return self._defaults[index]

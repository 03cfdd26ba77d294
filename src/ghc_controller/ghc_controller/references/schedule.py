"""Which reference each task follows at which time."""

from __future__ import annotations

import math
from bisect import bisect_right, insort_right
from collections.abc import Sequence
from operator import attrgetter

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.references.follower import Follower
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.types import TaskTarget

MOST_WAITING = 1000  # [-] references of a task whose start is still to come
MOST_POINTS = 200_000  # [-] of all that wait, where several do
_START = attrgetter("start_time")


class ReferenceSchedule:
    """References by task; the one that started last is followed, future ones are queued.

    A task without a reference follows its configured one, or holds its value at `begin`.

    Attributes:
        rest_from, rest_until: [s] between which the last targets stay as they are.
    """

    def __init__(self, tasks: Sequence[Follower]) -> None:
        self._tasks = tuple(tasks)
        self._index = {task.name: i for i, task in enumerate(self._tasks)}
        self._targets: list[TaskTarget] = []  # of the last time
        self.rest_from, self.rest_until = math.inf, -math.inf
        self.reset()

    def reset(self) -> None:
        """Forget every reference; `begin` must be called again."""
        self._queues: list[list[ReferenceTrajectory]] = [[] for _ in self._tasks]
        self._points = 0  # of all references in the queues
        self._defaults: list[TaskTarget] = []
        self._begun = False
        self._unrest()

    def begin(self, model: RobotModel, stay: bool = False) -> None:
        """Fix the targets of tasks without a reference at the state of the last update.

        With `stay`, tasks with a reference in robot.yaml also stay where they are.
        """
        self._defaults = [
            task.rest_target(model) if stay else task.default_target(model) for task in self._tasks
        ]
        self._begun = True
        self._unrest()

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
        """Add a reference; of two with the same start the newer one wins.

        Raises:
            UnknownName: the controller has no such task.
            InvalidValue: too many wait for their start already.
        """
        self.task(reference.task)
        queue = self._queues[self._index[reference.task]]
        waiting = len(queue) - 1  # behind the one that is followed
        if waiting >= MOST_WAITING:
            raise InvalidValue(
                f"task '{reference.task}': start {reference.start_time:g} s given; {waiting} "
                f"references wait for theirs, less than {MOST_WAITING} expected"
            )
        points = self._points + len(reference.times)
        if points > MOST_POINTS and self._points:
            raise InvalidValue(
                f"task '{reference.task}': {len(reference.times)} points given; those that wait "
                f"have {self._points}, at most {MOST_POINTS} in all expected"
            )
        self._points = points
        insort_right(queue, reference, key=_START)
        self._unrest()

    def current(self, name: str, time: float) -> TaskTarget:
        """Target of the task of that name at `time` [s]; UnknownName if there is none."""
        self.task(name)
        return self.target(self._index[name], time)

    def peek(self, name: str, time: float) -> TaskTarget:
        """As `current`, but read-only, for use in another thread.

        Raises:
            UnknownName: no such task. InvalidValue: it has no reference before the next state.
        """
        self.task(name)
        index = self._index[name]
        queue = tuple(self._queues[index])  # another thread may change the list meanwhile
        begun = bisect_right(queue, time, key=_START)
        if begun:
            return queue[begun - 1].target(time)
        defaults = self._defaults
        if not defaults:
            raise InvalidValue(
                f"task '{name}': no reference is in force before the next state; a position in "
                "every point expected"
            )
        return defaults[index]

    def targets(self, time: float) -> list[TaskTarget]:
        """Targets of all tasks at `time` [s], in their order; the same list while all rest."""
        if not self.rest_from <= time < self.rest_until:
            self._targets = [self.target(index, time) for index in range(len(self._tasks))]
            self.rest_from, self.rest_until = time, self._end_of_rest(time)
        return self._targets

    def _end_of_rest(self, time: float) -> float:
        """[s] until when the targets of `time` are in force; -inf where one moves."""
        until = math.inf
        for queue in self._queues:
            waiting = queue
            if queue and queue[0].start_time <= time:
                if not queue[0].rests(time):
                    return -math.inf
                waiting = queue[1:]
            if waiting:
                until = min(until, waiting[0].start_time)
        return until

    def _unrest(self) -> None:
        self._targets = []
        self.rest_from, self.rest_until = math.inf, -math.inf

    def target(self, index: int, time: float) -> TaskTarget:
        """Target of task number `index` at `time` [s]."""
        queue = self._queues[index]
        if len(queue) > 1 and queue[1].start_time <= time:
            over = bisect_right(queue, time, key=_START) - 1
            self._points -= sum(len(entry.times) for entry in queue[:over])
            del queue[:over]
        if queue and queue[0].start_time <= time:
            return queue[0].target(time)
        return self._defaults[index]

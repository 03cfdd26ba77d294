"""From target streams to references that the robot can follow: the parts in their order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.kinematics import Level
from ghc_controller.reachable.held_base import HeldBase
from ghc_controller.reachable.joint_motion import JointLimitsOfMotion, JointMotion
from ghc_controller.reachable.posture_goal import PostureGoal
from ghc_controller.reachable.settings import ReachableSettings
from ghc_controller.reachable.target_stream import TargetStream
from ghc_controller.reachable.task_points import task_references
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.robot.robot import Robot
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskTarget

_MILLISECOND = 1e-3  # [s] step of the joint motion
_POINT_STEP = 5  # [ms] between points of a plan, ...
_TAIL_STEP = 30  # ... and of the braking that ends it
_MOST_PLANS = 20  # periods made up for after a gap of the clock
_NEAR = 0.02  # [m], [rad] of the robot from the last reference, to go on from there
_SILENT = 1.0  # [s] without a sample, at rest: the next one starts anew
_AT_REST = 1e-9  # [rad/s], [rad/s^2]


class ReachableReference:
    """Targets in, trajectories out, once a period.

    Sample -> checks, estimate at the time of the output, filter (TargetStream) -> nearest posture
    (PostureGoal) -> joint motion within limits (JointMotion) -> points of the tasks.

    A plan has points over one period, goes on for two more as if the target kept its velocity, and
    ends with braking to rest: if the node stops, the robot brakes smoothly.

    A floating base counts as at rest where it is when a motion begins; the tasks of the controller
    have to keep it there. Joints that do not move a task stay where they are.

    Attributes:
        limits: of the joint motion.
        streams: by task.
        joint_motion: (s, 3, n) q, v, a at every ms of the last plan; none where nothing was due.
    """

    def __init__(
        self,
        robot: Robot,
        tasks: Sequence[str],
        settings: ReachableSettings | None = None,
        posture: str = "",
    ) -> None:
        """The robot must not be used elsewhere: its model is updated here.

        Args:
            tasks: with a target stream each, highest priority first.
            posture: a further task without targets that is given the posture, "" for none.

        Raises:
            ConfigurationError: no task.
            UnknownName: a task does not exist.
            InvalidValue: a task is named twice.
        """
        if not tasks:
            raise ConfigurationError("tasks: none given, at least one expected")
        names = [*tasks, *([posture] if posture else [])]
        if len(set(names)) != len(names):
            raise InvalidValue(f"tasks: {', '.join(names)} given, each once expected")
        self.settings = settings or ReachableSettings()
        self._robot, self._steps = (
            HeldBase(robot.model),
            round(self.settings.period / _MILLISECOND),
        )
        self._targeted = [_task(robot, name) for name in tasks]
        self._followed = self._targeted + ([_task(robot, posture)] if posture else [])
        self.limits = JointLimitsOfMotion.of(robot.model, self.settings)
        self.streams = {t.name: TargetStream(t, self.settings) for t in self._targeted}
        self.reset()

    def reset(self) -> None:
        """Forget samples and motion."""
        for stream in self.streams.values():
            stream.reset()
        self.joint_motion = np.zeros((0, 3, self._robot.n))
        self._motion: JointMotion | None = None
        self._goal: PostureGoal | None = None
        self._last: Array | None = None  # (n,) where a reference ended
        self._time = 0.0  # [s] of the output
        self._rests = False  # the last plan was at rest, and sent

    @property
    def has_begun(self) -> bool:
        """True from the first sample on."""
        return any(stream.has_begun for stream in self.streams.values())

    @property
    def output(self) -> Array:
        """(3, n) joint positions, velocities and accelerations at the end of the last plan.

        Raises:
            RuntimeError: no plan was made yet.
        """
        if self._motion is None:
            raise RuntimeError("output needs a plan before it")
        return self._motion.output

    def add(self, task: str, position: ArrayLike, now: float, stamp: float | None = None) -> None:
        """Take a sample of the target of a task.

        Args:
            position: as a reference of the task: [m], [rad], quaternions x, y, z, w.
            now: [s] time of the robot.
            stamp: [s] when the target was there; without, estimated from the arrival times.

        Raises:
            UnknownName: the task has no stream.
            WrongSize, InvalidValue: see TargetStream.add.
        """
        if task not in self.streams:
            raise UnknownName("task with a target stream", task, self.streams)
        values = np.array(position, dtype=np.float64)
        self.streams[task].add(stamp, values, now)

    def position_of(self, task: str, q: Array) -> Array:
        """Reference position of a task at joint positions q (n,), (position_size,)."""
        self._robot.update(q)
        return self.streams[task].task.current(self._robot.model).copy()

    def plan(self, state: RobotState) -> tuple[ReferenceTrajectory, ...]:
        """Trajectories from the end of the last plan on, empty where nothing moves.

        Args:
            state: of the robot now; where it is counts for the first plan only.
        """
        if not self.has_begun:
            return ()
        end = state.time + self.settings.lead + self.settings.period
        late = end - self._time > _MOST_PLANS * self.settings.period
        if self._motion is None or self._goal is None or late:
            self._begin(state)
        times, rows = [self._time], [self.output]
        made = [np.zeros((0, 3, self._robot.n))]
        while self._time < end - 0.5 * self.settings.period:
            motion = self._advance()
            made.append(motion)
            for k in range(_POINT_STEP, self._steps + 1, _POINT_STEP):
                times.append(self._time + k * _MILLISECOND)
                rows.append(motion[k - 1])
            if self._steps % _POINT_STEP:
                times.append(self._time + self._steps * _MILLISECOND)
                rows.append(motion[-1])
            self._time += self._steps * _MILLISECOND
        self.joint_motion = np.concatenate(made)
        if len(times) == 1:
            return ()
        at_rest = bool(np.abs(np.array(rows)[:, 1:]).max() < _AT_REST)
        if at_rest and self._rests:
            self._sleep(state.time)
            return ()
        self._rests = at_rest
        self._add_tail(times, rows)
        return task_references(self._robot, self._followed, np.array(times), np.array(rows))

    def _sleep(self, now: float) -> None:
        """Discard the targets once samples stop: the robot may be moved by others from then on."""
        if all(now - stream.time > _SILENT for stream in self.streams.values()):
            self._last = self.output[0]
            self._motion = self._goal = None
            for stream in self.streams.values():
                stream.reset()

    def _begin(self, state: RobotState) -> None:
        """Start at rest where the robot is, or where the last reference ended if that is near."""
        q = self._robot.hold(state)
        if self._last is not None and all(
            self._distance(task, q, self._last) < _NEAR for task in self._targeted
        ):
            q = self._last
        self._last = None
        limits = self.limits.containing(q)
        self._motion = JointMotion(self.limits, self.settings.smoothing, q)
        levels = [Level(task) for task in self._targeted]
        self._goal = PostureGoal(self._robot, levels, limits.lower, limits.upper, q, self.settings)
        self._time = state.time + self.settings.lead
        self._rests = False
        self._robot.update(q)
        for task in self._targeted:
            self.streams[task.name].begin(task.current(self._robot.model))

    def _distance(self, task: Task, q: Array, other: Array) -> float:
        target = TaskTarget(self.position_of(task.name, other), *np.zeros((2, task.size)))
        self._robot.update(q)
        return float(np.linalg.norm(task.measured(self._robot.model, target).error))

    def _advance(self) -> Array:
        """(steps, 3, n) of the next period."""
        assert self._motion is not None
        assert self._goal is not None
        period = self._steps * _MILLISECOND
        time = self._time + period + self._motion.delay
        before = self._goal.q
        self._goal.advance({n: s.follow(time, period) for n, s in self.streams.items()})
        rate = (self._goal.q - before) / period
        if self._goal.moved_over:
            rate = np.zeros_like(rate)
        most = self._motion.limits.velocity
        self._rate = np.clip(rate, -most, most)
        return self._motion.advance(self._goal.q, self._rate, self._steps)

    def _add_tail(self, times: list[float], rows: list[Array]) -> None:
        assert self._motion is not None
        assert self._goal is not None
        tail = self._motion.tail(self._goal.q, self._rate, 2 * self._steps)
        period = self._steps
        for k in sorted({period, len(tail), *range(2 * period, len(tail), _TAIL_STEP)}):
            times.append(self._time + k * _MILLISECOND)
            rows.append(tail[k - 1])


def _task(robot: Robot, name: str) -> Task:
    for task in robot.tasks:
        if task.name == name:
            return task
    raise UnknownName("task", name, robot.task_names)

"""Task errors over a run, recomputed from the log: what was reached, not what was claimed.

The robot file and the references are those of the run; nothing here comes from the controller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.robot.robot import Robot
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskTarget
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.references import Reference, ReferencePoint


@dataclass(frozen=True, slots=True)
class TaskHistory:
    """One task at the S sampled rows of a log."""

    name: str
    unit: str  # of the error
    error: Array  # (S,) norm of reference - actual over the rows under motion control
    position: Array  # (S, p) task variable
    reference: Array  # (S, p) its reference
    desired_force: Array | None  # (S, m) [N] to be exerted on the environment
    measured_force: Array | None  # (S, m) [N] exerted on the environment
    contact: str | None  # name of the contact that is measured


@dataclass(frozen=True, slots=True)
class RunHistory:
    """All tasks, and the gravity torque, at the sampled rows."""

    rows: NDArray[np.intp]  # (S,) rows of the log
    time: Array  # (S,) [s]
    tasks: tuple[TaskHistory, ...]
    gravity: Array  # (S, n) [Nm] torque that would hold the robot still


def recompute_history(
    log: FullRateLog,
    robot: Robot,
    references: Sequence[Reference],
    rows: NDArray[np.intp],
) -> RunHistory:
    """Evaluate all tasks of the robot at some rows of the log, in increasing order."""
    order = [log.joint_names.index(name) for name in robot.model.joint_names]
    states = [
        RobotState(
            time=float(log.time[row]),
            q=log.configuration(row, robot.model.joint_names),
            v=log.velocity(row, robot.model.joint_names),
            wrenches={name: wrench[row] for name, wrench in log.wrenches.items()},
        )
        for row in rows
    ]
    robot.model.update(states[0].q, states[0].v)
    targets = _targets(robot, references, float(log.time[-1]))
    samples: dict[str, list[_Sample]] = {task.name: [] for task in robot.tasks}
    stack = TaskStack(robot.tasks, robot.model.nv)
    gravity = np.empty((len(rows), len(order)))
    for k, state in enumerate(states):
        robot.model.update(state.q, state.v)
        gravity[k, order] = robot.model.gravity()[-len(order) :]
        now = [targets[task.name].target(state.time) for task in robot.tasks]
        stack.update(robot.model, state, now)
        for i, (task, target) in enumerate(zip(robot.tasks, now, strict=True)):
            samples[task.name].append(_sample(stack, i, robot, state, target))
    tasks = tuple(_history(task, samples[task.name]) for task in robot.tasks)
    return RunHistory(rows, log.time[rows], tasks, gravity)


def gravity_torques(log: FullRateLog, robot: Robot) -> Array:
    """Torque that would hold the robot still, at every row of a log, (T, n) [Nm].

    With a floating base: held by its base, which no contact does.
    """
    order = [log.joint_names.index(name) for name in robot.model.joint_names]
    still = np.zeros(robot.model.nv)
    gravity = np.empty_like(log.q)
    for k in range(len(log.time)):
        robot.model.update(log.configuration(k, robot.model.joint_names), still)
        gravity[k, order] = robot.model.gravity()[-len(order) :]
    return gravity


def reference_trajectory(task: Task, reference: Reference, duration: float) -> ReferenceTrajectory:
    """The trajectory that the controller makes of a scripted reference."""
    points = reference.points_until(duration)
    position = _column(points, "position")
    if position is None:
        raise ValueError(f"reference of task '{task.name}' has no position")
    if reference.joints and isinstance(task, PostureTask):
        position = task.ordered(reference.joints, position)
    return ReferenceTrajectory.for_task(
        task,
        np.array([point.time for point in points]),
        position,
        _column(points, "velocity"),
        _column(points, "acceleration"),
        _column(points, "wrench"),
    )


@dataclass(frozen=True, slots=True)
class _Sample:
    error: float
    position: Array
    reference: Array
    desired_force: Array | None
    measured_force: Array | None


def _targets(
    robot: Robot, references: Sequence[Reference], duration: float
) -> Mapping[str, ReferenceTrajectory]:
    scripted = {reference.task: reference for reference in references}
    return {
        task.name: reference_trajectory(task, scripted[task.name], duration)
        if task.name in scripted
        else ReferenceTrajectory.static(task, task.default_target(robot.model))
        for task in robot.tasks
    }


def _sample(
    stack: TaskStack, index: int, robot: Robot, state: RobotState, target: TaskTarget
) -> _Sample:
    task, error = stack.tasks[index], stack.error_of(index)
    if stack.force_rows[index]:
        error = error[~task.force_row_mask]
    measured = None
    if task.force is not None:
        wrench = state.wrenches.get(task.force.contact)
        if wrench is not None:
            measured = -wrench[["xyz".index(axis) for axis in task.labels]]
    return _Sample(
        error=float(np.linalg.norm(error)),
        position=task.current(robot.model).copy(),
        reference=target.position,
        desired_force=target.wrench,
        measured_force=measured,
    )


def _history(task: Task, samples: Sequence[_Sample]) -> TaskHistory:
    def stacked(values: list[Array | None]) -> Array | None:
        present = [value for value in values if value is not None]
        return np.stack(present) if len(present) == len(values) else None

    return TaskHistory(
        name=task.name,
        unit=task.error_unit,
        error=np.array([sample.error for sample in samples]),
        position=np.stack([sample.position for sample in samples]),
        reference=np.stack([sample.reference for sample in samples]),
        desired_force=stacked([sample.desired_force for sample in samples]),
        measured_force=stacked([sample.measured_force for sample in samples]),
        contact=None if task.force is None else task.force.contact,
    )


def _column(points: Sequence[ReferencePoint], name: str) -> Array | None:
    """(p, m) of one field; None when no point has it, the value before where one lacks it."""
    values: list[tuple[float, ...]] = [getattr(point, name) for point in points]
    size = max(len(value) for value in values)
    if size == 0:
        return None
    filled: list[tuple[float, ...]] = []
    for value in values:
        held = filled[-1] if filled and name == "position" else (0.0,) * size
        filled.append(value or held)
    return np.array(filled)

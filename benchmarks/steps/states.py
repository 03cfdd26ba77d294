"""States and goals for timing control steps, recorded from a closed loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

import ghc_controller as ghc
from ghc_controller.constraints import TorqueCenter, TorqueLimit
from ghc_controller.types import Array

DT = 1e-3  # [s] control period
_SPREAD = 0.15  # [rad] goals are poses at random postures this far from the start
TORQUE_SHARE = 0.2  # [-] torque bound about gravity, of the largest torque that tasks asked for
_LEAST_BOUND = 0.02  # [Nm]


@dataclass(frozen=True, slots=True)
class Segment:
    """Consecutive states of a closed loop on its way to random goals, one per task."""

    goals: tuple[ghc.ReferenceTrajectory, ...]
    states: tuple[ghc.RobotState, ...]


def random_goals(
    robot: ghc.Robot, start: Array, rng: np.random.Generator, count: int
) -> list[tuple[ghc.ReferenceTrajectory, ...]]:
    """`count` times a goal for every task, each the pose at a random posture of its own."""
    goals = []
    for _ in range(count):
        of_tasks = []
        for task in robot.tasks:
            posture = start + rng.uniform(-_SPREAD, _SPREAD, start.shape)
            robot.model.update(posture, np.zeros_like(start))
            target = task.static_target(task.current(robot.model))
            of_tasks.append(ghc.ReferenceTrajectory.static(task, target))
        goals.append(tuple(of_tasks))
    return goals


def closed_loop(
    controller: ghc.Controller,
    start: Array,
    goals: Sequence[tuple[ghc.ReferenceTrajectory, ...]],
    length: int,
) -> list[Segment]:
    """Drive the robot `length` periods towards each goal in turn; returns the states."""
    q, v = start.copy(), np.zeros_like(start)
    segments = []
    for of_tasks in goals:
        begin(controller, of_tasks)
        states = []
        for step in range(length):
            state = ghc.RobotState(step * DT, q.copy(), v.copy())
            result = controller.step(state)
            states.append(state)
            dynamics = controller.model.dynamics
            v = v + DT * np.linalg.solve(dynamics.mass_matrix, result.torque - dynamics.bias)
            q = q + DT * v
        segments.append(Segment(of_tasks, tuple(states)))
    return segments


def begin(controller: ghc.Controller, goals: Sequence[ghc.ReferenceTrajectory]) -> None:
    """Restart a controller with these goals."""
    controller.reset()
    for goal in goals:
        controller.add_reference(goal)


def torque_bound(controller: ghc.Controller, segments: Sequence[Segment]) -> Array:
    """(n,) [Nm] bound about gravity: a fraction of the unbounded torques."""
    largest = np.full(controller.model.nv, _LEAST_BOUND / TORQUE_SHARE)
    for segment in segments:
        begin(controller, segment.goals)
        for state in segment.states:
            torque = controller.step(state).torque
            largest = np.maximum(largest, np.abs(torque - controller.model.gravity()))
    return TORQUE_SHARE * largest


def with_torque_bound(robot: ghc.Robot, bound: Array) -> ghc.Robot:
    """The robot with a torque bound about gravity (a,) [Nm] among its constraints.

    The settings know one number for all joints; the regime with active bounds needs one for each.
    """
    box = TorqueLimit(bound, robot.model.na, TorqueCenter.GRAVITY, "torque_bound")
    return replace(robot, constraints=(*robot.constraints, box))

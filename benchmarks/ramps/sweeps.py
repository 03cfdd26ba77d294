"""Sweeps of the KUKA's state, target and bounds in small equal steps, at rest."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

import ghc_controller as ghc
from ghc_controller.types import Array, Bounds

_HAND_FIRST = "end_effector > elbow > posture"
_ELBOW_FIRST = "elbow > end_effector > posture"
_POSTURE = np.array([0.0, 0.2, 0.1, 1.0, -0.4, -0.9, 0.0])  # [rad]
_HAND, _ELBOW = np.array([0.61, 0.07, 0.82]), np.array([0.044303, -0.357625, 0.484112])  # [m]
_SPEED = 1.2  # [rad/s] limit of every joint, that of the arm's scenarios


@dataclass(frozen=True, slots=True)
class Sweep:
    """One sweep through p states, targets and bounds."""

    title: str
    hierarchy: str
    q: Array  # (p, 7) [rad]
    hand: Array  # (p, 3) [m] target
    box: Array | None = None  # (p,) [rad/s^2] on every joint, both ways


def sweeps(points: int) -> list[Sweep]:
    """All sweeps; with 600 points a posture moves by 1 mrad from one to the next."""
    s = np.linspace(-1.0, 1.0, points)
    elbow, wrist = np.tile(_POSTURE, (points, 1)), np.tile(_POSTURE, (points, 1))
    elbow[:, 3] = 0.3 * s
    wrist[:, 1], wrist[:, 3], wrist[:, 5] = 0.6, 1.0, 0.3 * s
    rest, hand = np.tile(_POSTURE, (points, 1)), np.tile(_HAND, (points, 1))
    box = np.ones(points)
    away = _way(np.linspace(0.0, 2.0, points))
    half, shrinking = _way(np.full(points, 0.5)), np.linspace(60.0, 3.0, points)
    return [
        Sweep("elbow through straight, hand first", _HAND_FIRST, elbow, hand),
        Sweep("wrist through straight, hand first", _HAND_FIRST, wrist, hand),
        Sweep("elbow through straight, elbow first", _ELBOW_FIRST, elbow, hand),
        Sweep("elbow through straight, hand first, box 8", _HAND_FIRST, elbow, hand, 8.0 * box),
        Sweep("target sweep, hand first, box 20", _HAND_FIRST, rest, away, 20.0 * box),
        Sweep("target sweep, elbow first, box 20", _ELBOW_FIRST, rest, away, 20.0 * box),
        Sweep("box sweep, hand first", _HAND_FIRST, rest, half, shrinking),
        Sweep("box sweep, elbow first", _ELBOW_FIRST, rest, half, shrinking),
    ]


def problems_of(sweep: Sweep) -> Iterator[ghc.ControlProblem]:
    """Control problems along a sweep: torque rate limit off, other limits of the product."""
    settings = ghc.Settings(torque_rate_limit=0.0, velocity_limit=_SPEED)
    controller = ghc.Controller.for_robot("kuka_lwr", settings)
    still = np.zeros(7)
    controller.observe(ghc.RobotState(0.0, sweep.q[0], still))
    tasks = {task.name: task for task in controller.robot.tasks}
    matrix = ghc.matrix_from_hierarchy(controller.robot.task_names, sweep.hierarchy)
    controller.add_transition(ghc.Transition(matrix, 0.0, 0.0, hierarchy=sweep.hierarchy), 0.0)
    for name, target in (("elbow", _ELBOW), ("posture", _POSTURE)):
        task = tasks[name]
        controller.add_reference(ghc.ReferenceTrajectory.static(task, task.static_target(target)))
    hand = tasks["end_effector"]
    for i, (q, target) in enumerate(zip(sweep.q, sweep.hand, strict=True)):
        controller.add_reference(ghc.ReferenceTrajectory.static(hand, hand.static_target(target)))
        controller.step(ghc.RobotState(1e-3 * i, q, still))
        problem = copy.deepcopy(controller.problem())
        if sweep.box is not None:
            limits = problem.acceleration
            lower = np.maximum(limits.lower, -sweep.box[i])
            upper = np.minimum(limits.upper, sweep.box[i])
            problem = replace(problem, acceleration=Bounds(lower, upper))
        yield problem


def _way(shares: Sequence[float] | Array) -> Array:
    """(p, 3) [m] targets of the hand on a line that leaves its reach."""
    return np.array([0.5, 0.1, 0.6]) + np.outer(shares, [0.6, 0.4, 0.5])

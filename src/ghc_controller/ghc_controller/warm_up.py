"""Compile and load every kernel of a controller, so that no tick takes longer for it."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from ghc_controller.constraints.obstacle import ObstacleDistance
from ghc_controller.contacts import BoundsInForce, ContactSet
from ghc_controller.formulations import Formulation
from ghc_controller.hierarchy import Solvability, TransitionSchedule
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.ramp import PacedPriorities, Ramp
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.preview import CONTACT_FORCES, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.report.report import StepResult
from ghc_controller.robot.robot import Robot
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, Bounds, RobotState


class Controller(Protocol):
    """What is used of a controller."""

    @property
    def robot(self) -> Robot: ...
    @property
    def model(self) -> RobotModel: ...
    @property
    def contacts(self) -> ContactSet: ...
    @property
    def force_bounds(self) -> BoundsInForce: ...
    @property
    def obstacles(self) -> ObstacleDistance: ...
    @property
    def formulation(self) -> Formulation: ...
    @property
    def priorities(self) -> TransitionSchedule: ...
    def add_reference(self, reference: ReferenceTrajectory) -> None: ...
    def step(self, state: RobotState) -> StepResult: ...
    def problem(self) -> ControlProblem: ...
    def sigma_min_of(self, alpha: Array) -> float: ...
    def solvability(self) -> Solvability: ...
    def reset(self) -> None: ...


def warm_up(controller: Controller) -> None:
    """Make every kind of step once and forget it all: in contact, at bounds, near obstacles."""
    robot, model = controller.robot, controller.model
    wrenches = {
        task.force.contact: np.full(6, 10.0 + 10.0 * task.force.threshold)
        for task in robot.tasks
        if task.force is not None
    }
    model.update(model.q, model.v)
    for task in robot.tasks:
        controller.add_reference(_moving_reference(task, model))
    for on in (False, True):
        if robot.contacts:
            controller.force_bounds.follow(_plan(controller.contacts.names, on))
        if on:
            controller.obstacles.follow(_obstacle(model))
        for time in (0.0, 0.5):
            q, v = model.q.copy(), np.zeros(model.nv)
            q[-model.na :] += 0.1 * time
            torque = np.zeros(model.na)
            controller.step(RobotState(time, q, v, torque, wrenches))
    problem = controller.problem()
    bias = problem.bias[problem.unactuated :]
    tight = Bounds(bias - 1e-3, bias + 1e-3)
    controller.formulation.solve(replace(problem, torque=tight))
    _relax(controller, replace(problem, torque=tight, torque_limit=tight))
    controller.sigma_min_of(controller.priorities.alpha)
    k = len(controller.robot.tasks)
    no_order = np.full((k, k), 0.25)
    controller.formulation.solve(replace(problem, priorities=Priorities.of(no_order)))
    if controller.formulation.blends:
        ramp = Ramp(problem.priorities.candidates, no_order)
        paced = PacedPriorities.on(ramp, 0.0, 1.0, 1.0)
        controller.formulation.solve(replace(problem, priorities=paced))
    controller.solvability().measure(no_order)
    controller.reset()


def _relax(controller: Controller, problem: ControlProblem) -> None:
    """Solve a problem whose bounds exclude each other: the second solver and what gives way."""
    counts = controller.formulation.solver.counts
    before = dict(counts)
    n = problem.bias.shape[0]
    ahead = Bounds(np.full(n, 1e3), np.full(n, 2e3))
    controller.formulation.solve(replace(problem, acceleration=ahead))
    counts.update(before)


def _plan(contacts: tuple[str, ...], on: bool) -> Preview:
    c = len(contacts)
    lower, upper = np.zeros((c, 2)), np.full((c, 2), 1e3)
    flags = (on,) * c
    status, none = (PreviewStatus.RAW,) * c, (False,) * c
    return Preview(CONTACT_FORCES, 0.0, 1.0, contacts, lower, upper, flags, status, none, False)


def _obstacle(model: RobotModel) -> Preview:
    """An obstacle that moves, far from the last frame: its row is there and not active."""
    frame = model.frame_names[-1]
    state, normal = np.zeros((3, 3)), np.array([0.0, 0.0, 1.0])
    state[0] = model.frame_position(model.frame_id(frame)) - 10.0 * normal
    obstacle = PlannedMotion(
        "warm_up", frame, 0.1, normal, state, np.zeros((2, 3)), PreviewStatus.SMOOTHED
    )
    return Preview.of_motions(0.0, 0.4, 2, (obstacle,))


def _moving_reference(task: Task, model: RobotModel) -> ReferenceTrajectory:
    """A reference of one second that uses every kind of interpolation of a task."""
    position = np.stack([task.current(model)] * 2)
    zeros = np.zeros((2, task.reference_size))
    wrench = None if task.force is None else zeros + 1.0
    return ReferenceTrajectory.for_task(task, np.array([0.0, 1.0]), position, zeros, zeros, wrench)

"""Robots and random states that the tests of model and tasks share."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.tasks.task import Task
from ghc_controller.types import Array, RobotState, TaskRows, TaskTarget

_BENT = {"hip_pitch": 0.41, "knee": -0.9, "ankle_pitch": -0.49}  # [rad], of both legs of iCub
ROBOTS = ("kuka_lwr", "manipulator", "humanoid")  # the last has a floating base, 32 coordinates


@cache
def pin_model(robot: str) -> pin.Model:
    """The robot as a plain pin.Model."""
    if robot == "manipulator":
        return pin.buildSampleModelManipulator()
    if robot == "humanoid":
        pin.seed(0)
        return pin.buildSampleModelHumanoidRandom()
    return pin.buildModelFromUrdf(str(load_robot_config(find_robot(robot)).urdf))


def make_model(robot: str) -> RobotModel:
    """A fresh RobotModel of one of ROBOTS."""
    return RobotModel(pin_model(robot))


def random_state(robot: str, rng: np.random.Generator) -> RobotState:
    """State with every coordinate away from zero; a base is turned and moved as well."""
    model = pin_model(robot)
    q = pin.integrate(model, pin.neutral(model), rng.uniform(-1.0, 1.0, model.nv))
    return RobotState(0.0, q, rng.uniform(-1.0, 1.0, model.nv))


def on_bent_knees(model: RobotModel, time: float) -> RobotState:
    """iCub at rest on both soles, its knees bent, at a time [s]."""
    q = model.q.copy()
    for place, name in enumerate(model.joint_names, start=model.nq - model.na):
        q[place] = _BENT.get(name[2:], 0.0)
    return RobotState(time, q, np.zeros(model.nv))


def moved(robot: str, q: Array, step: Array) -> Array:
    """Configuration after moving by `step` (n,)."""
    return np.asarray(pin.integrate(pin_model(robot), q, step))


def rows_of(task: Task, model: RobotModel, state: RobotState, target: TaskTarget) -> TaskRows:
    """Rows of one task with their law, out of contact; the model is updated with `state`."""
    stack = TaskStack([task], model.nv)
    stack.update(model, state, [target])
    return stack.rows

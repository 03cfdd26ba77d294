"""What of a controller changes continuously while it runs: gains, weights and limits, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from ghc_controller.constraints import ConstraintSet, ObstacleDistance
from ghc_controller.constraints.joint_velocity import JointVelocityLimit
from ghc_controller.constraints.torque_limit import TorqueLimit
from ghc_controller.constraints.torque_rate import TorqueRateLimit
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import Formulation
from ghc_controller.robot.robot import Robot
from ghc_controller.safety.gate import OutputGate
from ghc_controller.settings import Settings
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array

GAINS = ("stiffness", "damping")
# Numbers of FormulationSettings on which the answers depend continuously.
WEIGHTS = (
    "regularization",
    "velocity_damping",
    "null_damping",
    "torque_weight",
    "metric_ratio",
    "weight_ratio",
)
LIMITS = (
    "velocity_limit",
    "velocity_horizon",
    "torque_bound",
    "torque_rate_limit",
    "obstacle_horizon",
)


T = TypeVar("T")


class Controller(Protocol):
    """What is used of a controller."""

    robot: Robot
    stack: TaskStack
    formulation: Formulation
    constraints: ConstraintSet
    obstacles: ObstacleDistance
    gate: OutputGate
    settings: Settings


@dataclass(frozen=True, slots=True)
class Dial:
    """One quantity: its value now, and how another one is set."""

    read: Callable[[], Array]  # fresh array
    write: Callable[[Array], None]


def gain_names(robot: Robot) -> tuple[str, ...]:
    """Names of all gains, such as tasks.hand.stiffness."""
    return tuple(f"tasks.{task}.{gain}" for task in robot.task_names for gain in GAINS)


def gain_dial(controller: Controller, name: str) -> Dial:
    """Dial of a gain (m,) of a task."""
    stack, (_, task, gain) = controller.stack, name.split(".")
    index = controller.robot.task_names.index(task)

    def read() -> Array:
        return np.array(getattr(stack.tasks[index], gain))

    return Dial(read, lambda value: stack.set_gains(index, **{gain: value}))


def weight_dial(controller: Controller, name: str) -> Dial:
    """Dial of a number of FormulationSettings."""

    def read() -> Array:
        return np.array([getattr(controller.formulation.settings, name)])

    def write(value: Array) -> None:
        controller.formulation.retune(**{name: float(value[0])})

    return Dial(read, write)


def limit_dial(controller: Controller, name: str) -> Dial:
    """Dial of a limit.

    Raises:
        InvalidValue: it is off since the start, so that no constraint has it.
    """
    constraints = controller.constraints
    if name == "obstacle_horizon":
        obstacles = controller.obstacles
        return Dial(
            lambda: np.array([obstacles.horizon]),
            lambda value: setattr(obstacles, "horizon", float(value[0])),
        )
    if name == "torque_rate_limit":
        rate = _present(constraints, TorqueRateLimit, name)
        return Dial(rate.rate.copy, lambda value: _set_rate(controller, rate, value))
    if name == "torque_bound":
        return _array_dial(_present(constraints, TorqueLimit, name, "torque_bound").limit)
    velocity = _present(constraints, JointVelocityLimit, name)
    if name == "velocity_limit":
        return _array_dial(velocity.limit)
    return Dial(
        lambda: np.array([velocity.horizon]),
        lambda value: setattr(velocity, "horizon", float(value[0])),
    )


def limit_goal(controller: Controller, name: str, settings: Settings) -> Array | float:
    """What a limit shall be under other settings; InvalidValue where that is no limit."""
    robot = controller.robot
    goal: Array | float = getattr(settings, name)
    if name == "velocity_limit":
        goal = settings.velocity_limit or robot.model.limits.velocity
    elif name == "torque_rate_limit":
        goal = settings.rate_limit(robot)
    if not np.all(np.asarray(goal) > 0.0):
        raise InvalidValue(f"{name}: it cannot be switched off while running, {goal} given")
    return goal


def _array_dial(limit: Array) -> Dial:
    def write(value: Array) -> None:
        limit[:] = value

    return Dial(limit.copy, write)


def _set_rate(controller: Controller, rate: TorqueRateLimit, value: Array) -> None:
    """The rows, the jerk that limits plan with, and the gate keep one rate."""
    rate.set_rate(value)
    if controller.constraints.planned_jerk is not None:
        controller.constraints.planned_jerk.rate[:] = value
    controller.gate.torque_step_limit[:] = value * controller.settings.control_dt


def _present(constraints: ConstraintSet, kind: type[T], field: str, name: str = "") -> T:
    for one in constraints.constraints:
        if isinstance(one, kind) and (not name or one.name == name):
            return one
    raise InvalidValue(
        f"{field}: it is off since the start and cannot be switched on while running; start the "
        "controller with a limit"
    )

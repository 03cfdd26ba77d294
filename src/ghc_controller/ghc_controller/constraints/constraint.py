"""What a constraint is: a named box on joint accelerations or on torques."""

from __future__ import annotations

from abc import ABC, abstractmethod
from enum import Enum, IntEnum
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array, Bounds, Dynamics, RobotState


class Space(Enum):
    """Which quantity a constraint bounds."""

    ACCELERATION = "acceleration"  # dv (n,) [rad/s^2]; entries of a floating base stay free
    TORQUE = "torque"  # tau (a,) [Nm]


class Softness(IntEnum):
    """Who gives way first when bounds conflict: the largest value does."""

    HARD = 0  # torque limits: never
    RATE = 1  # torque rate
    SOFT = 2  # position and velocity limits


class Tick(NamedTuple):
    """What a constraint may depend on: one state, after `model.update`."""

    model: RobotModel  # updated with `state`
    dynamics: Dynamics  # result of that update
    state: RobotState
    previous_torque: Array | None  # (a,) [Nm] applied over the last period; None at the start
    dt: float  # [s] control period
    jerk: Array | None = None  # (a,) [rad/s^3] within the torque rate limit; None without one


class Constraint(ABC):
    """Lower and upper bound per entry, from the state of the last `model.update`.

    A new constraint is one new file in this folder with a subclass that implements `write`;
    ConstraintSet merges those of one space into one box and reports who binds by `name`.

    Attributes:
        name: unique name, as in active_constraints and slack_names.
        space, softness: see Space and Softness.
    """

    space: Space
    softness: Softness

    def __init__(self, name: str) -> None:
        """Store the name."""
        self.name = name

    @abstractmethod
    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the bounds into `lower` and `upper`, (n,) or (a,) by `space`.

        Both hold -inf and +inf at first and the values of the previous tick later; entries that
        this constraint never writes stay infinite.
        """

    def bounds(
        self,
        model: RobotModel,
        dynamics: Dynamics,
        state: RobotState,
        previous_torque: Array | None,
        dt: float,
    ) -> Bounds:
        """Bounds of this constraint alone, in fresh arrays; arguments as in Tick."""
        size = model.nv if self.space is Space.ACCELERATION else model.na
        lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
        self.write(Tick(model, dynamics, state, previous_torque, dt), lower, upper)
        return Bounds(lower, upper)


def positive_per_joint(value: float | Array, joints: int, what: str) -> Array:
    """One positive number, or one per joint, as (a,); +inf is allowed.

    Raises:
        InvalidValue, WrongSize: name `what`.
    """
    values = np.array(value, dtype=np.float64)
    if values.ndim == 0:
        values = np.full(joints, float(values))
    if values.shape != (joints,):
        raise WrongSize(what, values.shape, (joints,))
    if not (values > 0.0).all():
        raise InvalidValue(f"{what}: {values.tolist()} given, positive numbers expected")
    return values

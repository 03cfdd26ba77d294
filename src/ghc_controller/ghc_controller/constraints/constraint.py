"""What a constraint is: named rows lower <= A z <= upper on accelerations, torques or forces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from enum import Enum, IntEnum
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.preview import Preview
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.types import Array, Bounds, Dynamics, RobotState


class Space(Enum):
    """Which quantity z a constraint bounds."""

    ACCELERATION = "acceleration"  # x (n,) [rad/s^2]; boxes leave a floating base free
    TORQUE = "torque"  # tau (a,) [Nm]
    FORCE = "force"  # f (c,) of the contacts that are on [N]


class Softness(IntEnum):
    """Which constraint is relaxed first when bounds conflict: the largest value."""

    HARD = 0  # torque limits, friction cones: never
    FORCE = 1  # normal forces: last
    RATE = 2  # torque rate
    SOFT = 3  # position and velocity limits, obstacles


class Tick(NamedTuple):
    """What a constraint may depend on: one state, after `model.update`."""

    model: RobotModel  # updated with `state`
    dynamics: Dynamics  # result of that update
    state: RobotState
    previous_torque: Array | None  # (a,) [Nm] applied over the last period; None at the start
    dt: float  # [s] control period
    jerk: Array | None = None  # (a,) [rad/s^3] within the torque rate limit; None without one
    carried: Array | None = None  # (a, n) G: by G^T the base follows the joints (`PlannedJerk`)
    contacts: ContactRows | None = None  # that are on, without the rows on their forces


class Rows(NamedTuple):
    """r rows lower <= matrix z <= upper of one constraint at one state.

    A matrix on forces that stays the same from tick to tick, with its names, should be the same
    object, and not writable: what is made of both is then kept. Others are read at every tick.
    """

    matrix: Array  # (r, n), (r, a) or (r, c) by the space of the constraint
    lower: Array  # (r,) -inf = no bound
    upper: Array  # (r,) +inf = no bound
    names: tuple[str, ...]  # (r,) as in active_constraints and slack_names


class Constraint(ABC):
    """Rows on accelerations, torques or forces, from the state of the last `model.update`.

    A new constraint is one file with a subclass: of `BoxConstraint` for bounds on joints (A = I),
    of `DistanceConstraint` for one scalar that is kept in a range, of this one for any other rows.
    ConstraintSet puts all of them together.

    Bounds that change come in by `follow`, as a preview of its `kind`: that is kept, `rows` or
    `write` reads it at `tick.state.time`, `is_stale` says that it has ended, and `reset` forgets
    it.

    Attributes:
        name: unique name, as in active_constraints and slack_names.
        space, softness: see Space and Softness.
        kind: of the previews that it follows; empty = none.
        made_anew: makes it again for a model with the same frames, as `make_constraint` does it;
            None where it was made by hand.
    """

    space: Space
    softness: Softness
    kind: str = ""
    made_anew: Callable[[RobotModel], Constraint] | None = None

    def __init__(self, name: str) -> None:
        """Store the name."""
        self.name = name

    @abstractmethod
    def rows(self, tick: Tick) -> Rows | None:
        """Rows at this state; None without any."""

    def follow(
        self,
        preview: Preview,  # noqa: ARG002
        now: float | None = None,  # noqa: ARG002
    ) -> tuple[UnknownName, ...]:
        """Take over a preview of the bounds, which replaces the one before.

        Args:
            preview: of its kind.
            now: [s] from when on it is followed; None = from its start.

        Returns:
            What is left out, since the robot does not have it; empty where nothing is.

        Raises:
            InvalidValue: this constraint follows none, or not this one.
        """
        raise InvalidValue(f"constraint '{self.name}' follows no preview: its bounds are fixed")

    def is_stale(self, time: float) -> bool:  # noqa: ARG002
        """Whether the preview has ended at `time` [s]."""
        return False

    @property
    def is_idle(self) -> bool:
        """Whether it has no rows at any state until it is told otherwise; boxes are not asked."""
        return False

    def reset(self) -> None:  # noqa: B027
        """Forget previews and whatever is remembered of earlier states."""

    def __repr__(self) -> str:
        """Kind, name, space and place in the order of relaxation."""
        return f"{type(self).__name__}({self.name!r}, {self.space.name}, {self.softness.name})"


class BoxConstraint(Constraint):
    """A lower and an upper bound for each joint: rows with A = I.

    ConstraintSet merges those of one space into one box, entry by entry.
    """

    @abstractmethod
    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the bounds into `lower` and `upper`, (n,) or (a,) by `space`.

        Both hold -inf and +inf at first and the values of the previous tick later; entries that
        this constraint never writes stay infinite.
        """

    def rows(self, tick: Tick) -> Rows:
        """The box as rows, in fresh arrays."""
        model = tick.model
        names = model.joint_names
        if self.space is Space.ACCELERATION:
            names = tuple(f"base_{i}" for i in range(model.nv - model.na)) + names
        lower, upper = np.full(len(names), -np.inf), np.full(len(names), np.inf)
        self.write(tick, lower, upper)
        return Rows(
            np.eye(len(names)), lower, upper, tuple(f"{self.name}.{entry}" for entry in names)
        )

    def bounds(
        self,
        model: RobotModel,
        dynamics: Dynamics,
        state: RobotState,
        previous_torque: Array | None,
        dt: float,
    ) -> Bounds:
        """Bounds of this constraint alone, in fresh arrays; arguments as in Tick."""
        rows = self.rows(Tick(model, dynamics, state, previous_torque, dt))
        return Bounds(rows.lower, rows.upper)


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

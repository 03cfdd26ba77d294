"""All constraints of a controller, evaluated and merged once a tick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ghc_controller.constraints.box import Box, Slack, merge_boxes
from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Constraint,
    Softness,
    Space,
    Tick,
)
from ghc_controller.constraints.planned_jerk import PlannedJerk
from ghc_controller.constraints.row_stack import RowStack
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.problem.control_problem import AccelerationRows, ContactRows
from ghc_controller.types import Array, Bounds, Dynamics, RobotState

Kind = TypeVar("Kind", bound=Constraint)


@dataclass(frozen=True, slots=True)
class Boxes:
    """What the constraints allow at the last state; overwritten by ConstraintSet.update."""

    acceleration: Box  # (n,) [rad/s^2]
    torque: Box  # (a,) [Nm]


class ConstraintSet:
    """Constraints in any order; the merge goes by softness, then by the given order.

    Boxes of one space are merged into one, and all other rows are stacked.
    """

    def __init__(
        self,
        constraints: Sequence[Constraint],
        model: RobotModel,
        planned_jerk: PlannedJerk | None = None,
        in_contact: bool = False,
    ) -> None:
        """Prepare one merge for accelerations and one for torques.

        Args:
            planned_jerk: what position and velocity limits plan with; None without a rate limit.
            in_contact: whether contact forces can act on the robot.

        Raises:
            InvalidValue: two constraints share a name or follow previews of one kind, or rows that
                cannot be served: `RowStack`.
        """
        names = [constraint.name for constraint in constraints]
        for name in names:
            if names.count(name) > 1:
                raise InvalidValue(f"constraint name '{name}' is given twice; names must differ")
        kinds = [constraint.kind for constraint in constraints if constraint.kind]
        for kind in kinds:
            if kinds.count(kind) > 1:
                raise InvalidValue(
                    f"two constraints follow previews of kind '{kind}', one expected"
                )
        self.constraints = tuple(constraints)
        self.planned_jerk = planned_jerk
        base = tuple(f"base_{i}" for i in range(model.nv - model.na))
        boxes = [c for c in constraints if isinstance(c, BoxConstraint)]
        for box in boxes:
            if box.space is Space.FORCE:
                raise InvalidValue(f"constraint '{box.name}': a box on forces; rows expected")
        self._acceleration = _Merge(
            [c for c in boxes if c.space is Space.ACCELERATION], base + model.joint_names
        )
        self._torque = _Merge([c for c in boxes if c.space is Space.TORQUE], model.joint_names)
        self.following = tuple(c for c in constraints if c.kind)
        self._stack = RowStack(constraints, in_contact)
        self.boxes = Boxes(self._acceleration.box, self._torque.box)

    @property
    def limits(self) -> tuple[LimitsInForce, ...]:
        """Limits of the constraints that follow previews."""
        found = (getattr(constraint, "limits", None) for constraint in self.constraints)
        return tuple(limits for limits in found if isinstance(limits, LimitsInForce))

    @property
    def rows(self) -> AccelerationRows | None:
        """General rows at the state of the last update; None without any."""
        return self._stack.general

    def on_forces(self, contacts: ContactRows | None) -> ContactRows | None:
        """Contacts with the rows on forces of the last update, at which the same ones were on."""
        return None if contacts is None else self._stack.on_forces(contacts)

    def one_of(self, kind: type[Kind]) -> Kind:
        """The first constraint of a class.

        Raises:
            InvalidValue: there is none.
        """
        for constraint in self.constraints:
            if isinstance(constraint, kind):
                return constraint
        raise InvalidValue(f"no constraint is a {kind.__name__}")

    def is_stale(self, time: float) -> bool:
        """Whether a preview that a constraint follows has ended at `time` [s]."""
        return any(constraint.is_stale(time) for constraint in self.following)

    def reset(self) -> None:
        """Forget the last state and all previews."""
        for constraint in self.constraints:
            constraint.reset()
        if self.planned_jerk is not None:
            self.planned_jerk.reset()

    def update(
        self,
        model: RobotModel,
        dynamics: Dynamics,
        state: RobotState,
        previous_torque: Array | None,
        dt: float,
        contacts: ContactRows | None = None,
    ) -> Boxes:
        """Merged boxes at the state of the last `model.update`; arguments as in Tick.

        Args:
            contacts: the contacts that are on; None without.
        """
        jerk, planned = None, self.planned_jerk
        if planned is not None and previous_torque is not None:
            motion = None if contacts is None else contacts.jacobian
            jerk = planned.update(dynamics, state, motion, dt)
        carried = None if jerk is None or planned is None else planned.carried
        tick = Tick(model, dynamics, state, previous_torque, dt, jerk, carried, contacts)
        self._acceleration.update(tick)
        self._torque.update(tick)
        self._stack.update(tick)
        return self.boxes


class _Merge:
    """Constraints of one space with the memory for their boxes."""

    def __init__(self, constraints: list[BoxConstraint], entries: tuple[str, ...]) -> None:
        self._constraints = sorted(constraints, key=lambda constraint: constraint.softness)
        self._hard_count = sum(c.softness is Softness.HARD for c in constraints)
        shape = (len(constraints), len(entries))
        self._lowers, self._uppers = np.full(shape, -np.inf), np.full(shape, np.inf)
        self._slack = np.zeros(shape)
        self._rows = list(zip(self._constraints, self._lowers, self._uppers, strict=True))
        self._merged = np.empty((4, len(entries)))
        self._sources = np.empty((2, len(entries)), dtype=np.int64)
        self.box = Box(
            Bounds(self._merged[0], self._merged[1]),
            Bounds(self._merged[2], self._merged[3]),
            self._sources[0],
            self._sources[1],
            (),
            tuple(constraint.name for constraint in self._constraints),
            entries,
        )

    def update(self, tick: Tick) -> None:
        for constraint, lower, upper in self._rows:
            constraint.write(tick, lower, upper)
        gave_way = merge_boxes(
            self._lowers,
            self._uppers,
            self._hard_count,
            self._merged,
            self._sources,
            self._slack,
        )
        self.box.slack = self._named_slack() if gave_way else ()

    def _named_slack(self) -> tuple[Slack, ...]:
        box = self.box
        return tuple(
            Slack(f"{box.names[c]}.{box.entries[entry]}", float(self._slack[c, entry]))
            for c, entry in np.argwhere(self._slack > 0.0)
        )

"""All constraints of a controller, evaluated and merged once a tick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from ghc_controller.constraints.box import Box, Slack
from ghc_controller.constraints.compiled import CompiledBox, written_by_core
from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Constraint,
    Softness,
    Space,
    Tick,
)
from ghc_controller.constraints.joint_position import JointPositionLimit
from ghc_controller.constraints.obstacle import ObstacleDistance
from ghc_controller.constraints.planned_jerk import PlannedJerk
from ghc_controller.constraints.row_stack import RowStack
from ghc_controller.constraints.torque_limit import TorqueLimit
from ghc_controller.core import BoxMerge, JerkPlan
from ghc_controller.errors import InvalidValue
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.problem.control_problem import AccelerationRows, ContactRows
from ghc_controller.types import Array, Bounds, Dynamics, RobotState

_TOLD = (TorqueLimit, JointPositionLimit, ObstacleDistance)

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
    ) -> None:
        """Prepare one merge for accelerations and one for torques.

        Args:
            planned_jerk: what position and velocity limits plan with; None without a rate limit.

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
        self._stack = RowStack(constraints)
        self._on_motion = self._stack.on_motion
        self._timed = (*self._acceleration.timed, *self._torque.timed)
        # Where a class is a plug-in's, only a call of its methods says whether something changed.
        told = all(type(one) in _TOLD for one in (*self.following, *self._timed))
        self._previewed = self.limits if told else None
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
        for constraint in self.following:  # noqa: SIM110 (a generator takes twice as long)
            if constraint.is_stale(time):
                return True
        return False

    @property
    def cores(self) -> tuple[BoxMerge, BoxMerge, JerkPlan | None] | None:
        """Boxes on accelerations and torques and the planned jerk; None: Python writes a box."""
        if self._acceleration.plugged or self._torque.plugged:
            return None
        planned, n = self.planned_jerk, len(self._acceleration.box.entries)
        jerk = None if planned is None else planned.core_of(n)
        return self._acceleration.core, self._torque.core, jerk

    @property
    def has_rows(self) -> bool:
        """Whether a constraint may have general rows or rows on forces."""
        return not self._stack.is_idle

    @property
    def rests(self) -> bool:
        """Whether `prepare` and `is_stale` have nothing to do, whatever the time, while no contact
        is on: no preview is followed, and there are no rows.
        """
        if self._previewed is None:
            return False
        for limits in self._previewed:
            if limits.preview is not None:
                return False
        for one in self._on_motion:  # noqa: SIM110 (a generator takes twice as long)
            if not one.is_idle:
                return False
        return True

    def prepare(self, time: float) -> None:
        """Tell the core what the boxes are at `time` [s]; there are no rows (`has_rows`)."""
        if self._stack.general is not None:
            self._stack.clear()
        for timed in self._timed:
            timed.prepare(time)

    def note(self, gave_way: bool) -> None:
        """Take over that the core merged the boxes, and whether one gave way."""
        self._acceleration.note(gave_way)
        self._torque.note(gave_way)

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
        hard = sum(c.softness is Softness.HARD for c in constraints)
        shape = (len(constraints), len(entries))
        lowers, uppers = np.full(shape, -np.inf), np.full(shape, np.inf)
        self._slack = np.zeros(shape)
        self._merged = np.empty((4, len(entries)))
        self._sources = np.empty((2, len(entries)), dtype=np.int64)
        compiled = [written_by_core(constraint) for constraint in self._constraints]
        self.core = BoxMerge(
            compiled, hard, lowers, uppers, self._merged, self._sources, self._slack
        )
        # Of the core, those whose bounds change with time; and those that Python writes.
        self.timed: list[CompiledBox] = []
        self.plugged: list[tuple[BoxConstraint, Array, Array]] = []
        for one, box, lower, upper in zip(
            self._constraints, compiled, lowers, uppers, strict=True
        ):
            if box is None:
                self.plugged.append((one, lower, upper))
            elif isinstance(one, CompiledBox) and one.changes:
                self.timed.append(one)
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
        for timed in self.timed:
            timed.prepare(tick.state.time)
        for plugged, lower, upper in self.plugged:
            plugged.write(tick, lower, upper)
        self.note(self.core.update(tick.model.core, tick.previous_torque, tick.dt, tick.jerk))

    def note(self, gave_way: bool) -> None:
        self.box.slack = self._named_slack() if gave_way else ()

    def _named_slack(self) -> tuple[Slack, ...]:
        box = self.box
        return tuple(
            Slack(f"{box.names[c]}.{box.entries[entry]}", float(self._slack[c, entry]))
            for c, entry in np.argwhere(self._slack > 0.0)
        )

"""The rows of all constraints that are no boxes: on accelerations, on torques, on forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Constraint,
    Rows,
    Softness,
    Space,
    Tick,
)
from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.problem.control_problem import AccelerationRows, ContactRows
from ghc_controller.types import Array

_ALLOWED = {
    Space.ACCELERATION: (Softness.SOFT,),
    Space.TORQUE: (Softness.SOFT,),
    Space.FORCE: (Softness.FORCE, Softness.HARD),
}


class RowStack:
    """Rows of several constraints, one below the other; the relaxed ones of forces come first.

    Rows A tau on torques become rows on accelerations by tau = M_a x + h_a, which holds for a
    robot without contacts.

    Attributes:
        general: rows on accelerations at the last update; None without any.
    """

    def __init__(self, constraints: Sequence[Constraint], in_contact: bool) -> None:
        """Take the constraints that are no boxes.

        Args:
            in_contact: whether contact forces can act on the robot.

        Raises:
            InvalidValue: a softness that rows of a space cannot have, or rows on torques of a
                robot with contacts.
        """
        rows = [one for one in constraints if not isinstance(one, BoxConstraint)]
        for one in rows:
            _check(one, in_contact)
        self._general = [one for one in rows if one.space is not Space.FORCE]
        forces = [one for one in rows if one.space is Space.FORCE]
        self._relaxed = [one for one in forces if one.softness is Softness.FORCE]
        self._hard = [one for one in forces if one.softness is Softness.HARD]
        self.general: AccelerationRows | None = None
        self._forces: list[Rows] = []
        self._bounds = 0
        self._stacked: list[Array] = []  # the matrices that _matrix and _names are made of
        self._matrix, self._names = np.zeros((0, 0)), tuple[str, ...]()

    def update(self, tick: Tick) -> None:
        """Evaluate all rows at a state, those on forces for the contacts that are on."""
        n = tick.model.nv
        found = [rows for one in self._general if (rows := _general(one, tick, n)) is not None]
        self.general = _stacked(found) if found else None
        if tick.contacts is None:
            self._forces = []
            return
        c = tick.contacts.force_jacobian.shape[0]
        self._forces = [rows for one in self._relaxed if (rows := _rows(one, tick, c))]
        self._bounds = sum(len(rows.names) for rows in self._forces)
        self._forces += [rows for one in self._hard if (rows := _rows(one, tick, c))]

    def on_forces(self, contacts: ContactRows) -> ContactRows:
        """The same contacts with the rows on their forces of the last update."""
        forces = self._forces
        if not forces:
            return contacts
        if len(forces) != len(self._stacked) or any(
            rows.matrix is not kept for rows, kept in zip(forces, self._stacked, strict=True)
        ):
            self._stacked = [rows.matrix for rows in forces]
            self._matrix = np.vstack(self._stacked)
            self._names = sum((rows.names for rows in forces), ())
        return ContactRows(  # _replace takes five times as long
            contacts.jacobian,
            contacts.drift_target,
            contacts.force_jacobian,
            self._matrix,
            np.concatenate([rows.lower for rows in forces]),
            np.concatenate([rows.upper for rows in forces]),
            contacts.force_center,
            contacts.force_factor,
            self._names,
            self._bounds,
            contacts.forces,
        )


def _check(one: Constraint, in_contact: bool) -> None:
    allowed = _ALLOWED[one.space]
    if one.softness not in allowed:
        raise InvalidValue(
            f"constraint '{one.name}': rows on {one.space.value} with softness "
            f"{one.softness.name} given, {' or '.join(kind.name for kind in allowed)} expected"
        )
    if one.space is Space.TORQUE and in_contact:
        raise InvalidValue(
            f"constraint '{one.name}': rows on torques are served for robots without contacts; "
            "a box on torques is served for all"
        )


def _rows(one: Constraint, tick: Tick, size: int) -> Rows | None:
    rows = one.rows(tick)
    if rows is None:
        return None
    shape = (len(rows.names), size)
    if rows.matrix.shape != shape:
        raise WrongSize(f"constraint '{one.name}': matrix", rows.matrix.shape, shape)
    return rows


def _general(one: Constraint, tick: Tick, n: int) -> Rows | None:
    """Rows (r, n) on accelerations; those on torques by tau = M_a x + h_a."""
    if one.space is Space.ACCELERATION:
        return _rows(one, tick, n)
    joints = tick.model.na
    rows = _rows(one, tick, joints)
    if rows is None:
        return None
    rest = rows.matrix @ tick.dynamics.bias[n - joints :]
    matrix = rows.matrix @ tick.dynamics.mass_matrix[n - joints :]
    return Rows(matrix, rows.lower - rest, rows.upper - rest, rows.names)


def _stacked(found: list[Rows]) -> AccelerationRows:
    if len(found) == 1:
        return AccelerationRows(*found[0])
    return AccelerationRows(
        np.vstack([rows.matrix for rows in found]),
        np.concatenate([rows.lower for rows in found]),
        np.concatenate([rows.upper for rows in found]),
        sum((rows.names for rows in found), ()),
    )

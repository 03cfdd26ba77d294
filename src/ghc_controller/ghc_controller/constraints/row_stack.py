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
    Space.TORQUE: (Softness.SOFT, Softness.HARD),
    Space.FORCE: (Softness.FORCE, Softness.HARD),
}


class RowStack:
    """Rows of several constraints, one below the other; the relaxed ones of forces come first.

    Rows A tau on torques become rows on accelerations and contact forces by the equation of
    motion, tau = M_a x + h_a - J_fa^T f; h with the forces that tasks exert (`RobotModel.exert`).

    Attributes:
        general: rows on accelerations and torques at the last update, those that are never
            relaxed last; None without any.
        on_motion: the constraints that may have them; those of all others need a contact.
    """

    def __init__(self, constraints: Sequence[Constraint]) -> None:
        """Take the constraints that are no boxes.

        Raises:
            InvalidValue: a softness that rows of a space cannot have.
        """
        rows = [one for one in constraints if not isinstance(one, BoxConstraint)]
        for one in rows:
            _check(one)
        self._all = rows
        general = [one for one in rows if one.space is not Space.FORCE]
        self.on_motion = sorted(general, key=lambda one: one.softness is Softness.HARD)
        forces = [one for one in rows if one.space is Space.FORCE]
        self._relaxed = [one for one in forces if one.softness is Softness.FORCE]
        self._hard = [one for one in forces if one.softness is Softness.HARD]
        self.general: AccelerationRows | None = None
        self._forces: list[Rows] = []
        self._bounds = 0
        # The matrices and names that _matrix and _names are made of.
        self._stacked: list[tuple[Array, tuple[str, ...]]] = []
        self._matrix, self._names = np.zeros((0, 0)), tuple[str, ...]()

    def update(self, tick: Tick) -> None:
        """Evaluate all rows at a state, those on forces for the contacts that are on."""
        n = tick.model.nv
        general = [_general(one, tick, n) for one in self.on_motion]
        found = [one for one in general if one is not None]
        self.general = _stacked(found) if found else None
        if tick.contacts is None:
            self._forces = []
            return
        c = tick.contacts.force_jacobian.shape[0]
        self._forces = [rows for one in self._relaxed if (rows := _rows(one, tick, c))]
        self._bounds = sum(len(rows.names) for rows in self._forces)
        self._forces += [rows for one in self._hard if (rows := _rows(one, tick, c))]

    @property
    def is_idle(self) -> bool:
        """Whether no constraint has rows: then there are none, without an update."""
        for one in self._all:  # noqa: SIM110 (a generator takes twice as long)
            if not one.is_idle:
                return False
        return True

    def clear(self) -> None:
        """Have no rows."""
        self.general, self._forces = None, []

    def on_forces(self, contacts: ContactRows) -> ContactRows:
        """The same contacts with the rows on their forces of the last update."""
        forces = self._forces
        if not forces:
            return contacts
        if len(forces) != len(self._stacked) or any(
            rows.matrix is not kept or rows.names is not names or kept.flags.writeable
            for rows, (kept, names) in zip(forces, self._stacked, strict=True)
        ):
            self._stacked = [(rows.matrix, rows.names) for rows in forces]
            self._matrix = np.vstack([rows.matrix for rows in forces])
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
            contacts.of_candidates,
        )


def _check(one: Constraint) -> None:
    allowed = _ALLOWED[one.space]
    if one.softness not in allowed:
        raise InvalidValue(
            f"constraint '{one.name}': rows on {one.space.value} with softness "
            f"{one.softness.name} given, {' or '.join(kind.name for kind in allowed)} expected"
        )


def _rows(one: Constraint, tick: Tick, size: int) -> Rows | None:
    rows = one.rows(tick)
    if rows is None:
        return None
    shape = (len(rows.names), size)
    if rows.matrix.shape != shape:
        raise WrongSize(f"constraint '{one.name}': matrix", rows.matrix.shape, shape)
    return rows


def _general(one: Constraint, tick: Tick, n: int) -> AccelerationRows | None:
    """Rows of a constraint on accelerations (n,) and, of one on torques in contact, on forces."""
    if one.space is Space.ACCELERATION:
        rows = _rows(one, tick, n)
        return None if rows is None else AccelerationRows(*rows)
    joints, dynamics = tick.model.na, tick.model.dynamics
    rows = _rows(one, tick, joints)
    if rows is None:
        return None
    rest = rows.matrix @ dynamics.bias[n - joints :]
    return AccelerationRows(
        rows.matrix @ dynamics.mass_matrix[n - joints :],
        rows.lower - rest,
        rows.upper - rest,
        rows.names,
        None
        if tick.contacts is None
        else -rows.matrix @ tick.contacts.force_jacobian[:, n - joints :].T,
        len(rows.names) if one.softness is Softness.HARD else 0,
    )


def _stacked(found: list[AccelerationRows]) -> AccelerationRows:
    if len(found) == 1:
        return found[0]
    given = [rows.force_matrix for rows in found if rows.force_matrix is not None]
    return AccelerationRows(
        np.vstack([rows.matrix for rows in found]),
        np.concatenate([rows.lower for rows in found]),
        np.concatenate([rows.upper for rows in found]),
        sum((rows.names for rows in found), ()),
        np.vstack([_force_matrix(rows, given[0].shape[1]) for rows in found]) if given else None,
        sum(rows.hard for rows in found),
    )


def _force_matrix(rows: AccelerationRows, c: int) -> Array:
    return np.zeros((len(rows.names), c)) if rows.force_matrix is None else rows.force_matrix

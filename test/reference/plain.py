"""Control problems as plain arrays: what the reference and the generators share.

n velocity coordinates, the first u of them unactuated, a = n - u joints. Equation of motion:
M x + h = [0; tau] + J_f^T f.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Level(NamedTuple):
    """One priority level: jacobian x -> target."""

    jacobian: Array  # (m, n)
    target: Array  # (m,)


class Rows(NamedTuple):
    """lower <= matrix x <= upper."""

    matrix: Array  # (r, n)
    lower: Array  # (r,)
    upper: Array  # (r,)


class Contacts(NamedTuple):
    """Motion rows J_c x = d, forces f, rows on them, and the cost 1/2 |F^-1 (f - f_0)|^2."""

    jacobian: Array  # (q, n) J_c
    drift: Array  # (q,) d
    force_jacobian: Array  # (c, n) J_f
    forces: Rows  # on f (r, c) [N]
    center: Array  # (c,) [N] f_0
    factor: Array  # (c, c) F with F F^T = H_f^-1
    bounds: int  # how many of the force rows are normal force bounds; they come first


class Plain(NamedTuple):
    """One problem; levels[0] has the highest priority."""

    levels: tuple[Level, ...]
    mass: Array  # (n, n)
    bias: Array  # (n,)
    lower: Array  # (n,) [rad/s^2]
    upper: Array  # (n,)
    torque_lower: Array  # (a,) [Nm]
    torque_upper: Array  # (a,)
    rows: Rows | None = None
    contacts: Contacts | None = None
    unactuated: int = 0

    @property
    def force_jacobian(self) -> Array:
        """(c, n), c = 0 without contacts."""
        n = len(self.bias)
        return np.zeros((0, n)) if self.contacts is None else self.contacts.force_jacobian

    def torque(self, x: Array, force: Array) -> Array:
        """(a,) [Nm] of accelerations (n,) and contact forces (c,)."""
        full = self.mass @ x + self.bias - self.force_jacobian.T @ force
        return full[self.unactuated :]


class Violations(NamedTuple):
    """Largest violation of each kind of row, 0 where all are met."""

    acceleration: float  # [rad/s^2] box
    rows: float  # [rad/s^2] general rows
    torque: float  # [Nm]
    force: float  # [N] friction and normal force
    balance: float  # [N], [Nm] equation of motion of the unactuated coordinates
    motion: float  # [rad/s^2], [m/s^2] of contacts


def violations(problem: Plain, x: Array, force: Array) -> Violations:
    """By how much accelerations (n,) and forces (c,) miss the rows, from M, J and the bounds."""
    u, contacts, general = problem.unactuated, problem.contacts, problem.rows
    full = problem.mass @ x + problem.bias - problem.force_jacobian.T @ force
    return Violations(
        _excess(x, problem.lower, problem.upper),
        0.0 if general is None else _excess(general.matrix @ x, general.lower, general.upper),
        _excess(full[u:], problem.torque_lower, problem.torque_upper),
        0.0
        if contacts is None
        else _excess(contacts.forces.matrix @ force, contacts.forces.lower, contacts.forces.upper),
        float(np.max(np.abs(full[:u]), initial=0.0)),
        0.0
        if contacts is None
        else float(np.max(np.abs(contacts.jacobian @ x - contacts.drift), initial=0.0)),
    )


def _excess(value: Array, lower: Array, upper: Array) -> float:
    return float(np.max(np.maximum(lower - value, value - upper), initial=0.0))

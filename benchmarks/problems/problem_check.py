"""A control problem judged from its data alone: violations in physical units, and feasibility."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

import ghc_controller as ghc
from ghc_controller.types import Array

_FEASIBLE = 1e-6  # [rad/s^2], [Nm], [N] largest violation of a point that counts as feasible


class Rows(NamedTuple):
    """Constraints on z = (x, f): equality @ z = value, lower <= matrix @ z <= upper."""

    equality: Array  # (e, n + c)
    value: Array  # (e,)
    matrix: Array  # (r, n + c)
    lower: Array  # (r,)
    upper: Array  # (r,)


def rows_of(problem: ghc.ControlProblem) -> Rows:
    """Hard and soft rows of a problem alike: motion, torque and contact force bounds."""
    n, u = problem.mass_matrix.shape[0], problem.unactuated
    contacts = problem.contacts
    push = np.zeros((0, n)) if contacts is None else contacts.force_jacobian
    c = push.shape[0]
    dynamics = np.hstack([problem.mass_matrix, -push.T])
    motion = np.hstack([np.eye(n), np.zeros((n, c))])
    equality, value = [dynamics[:u]], [-problem.bias[:u]]
    matrix, torque = [motion, dynamics[u:]], problem.torque
    lower = [problem.acceleration.lower, torque.lower - problem.bias[u:]]
    upper = [problem.acceleration.upper, torque.upper - problem.bias[u:]]
    if problem.rows is not None:
        matrix.append(problem.rows.matrix @ motion)
        lower.append(problem.rows.lower)
        upper.append(problem.rows.upper)
    if contacts is not None:
        still = np.hstack([contacts.jacobian, np.zeros((len(contacts.jacobian), c))])
        equality.append(still)
        value.append(contacts.drift_target)
        matrix.append(
            np.hstack([np.zeros((len(contacts.force_matrix), n)), contacts.force_matrix])
        )
        lower.append(contacts.force_lower)
        upper.append(contacts.force_upper)
    return Rows(
        np.vstack(equality),
        np.concatenate(value),
        np.vstack(matrix),
        np.concatenate(lower),
        np.concatenate(upper),
    )


def violation(problem: ghc.ControlProblem, solution: ghc.Solution) -> float:
    """Largest violation of any row [rad/s^2], [Nm] or [N], recomputed from x and f.

    The torques are checked twice: as they follow from x and f, and against those of the answer.
    """
    rows = rows_of(problem)
    z = np.concatenate([solution.acceleration, solution.force])
    u = problem.unactuated
    torque = problem.mass_matrix @ solution.acceleration + problem.bias
    if problem.contacts is not None:
        torque = torque - problem.contacts.force_jacobian.T @ solution.force
    reached = rows.matrix @ z
    worst = [
        np.abs(rows.equality @ z - rows.value),
        rows.lower - reached,
        reached - rows.upper,
        np.abs(torque[u:] - solution.torque),
        solution.torque - problem.torque.upper,
        problem.torque.lower - solution.torque,
    ]
    return max(0.0, *(float(part.max()) for part in worst if part.size))


def is_feasible(problem: ghc.ControlProblem) -> bool:
    """True when some x and f meet every row: phase one of a linear program (HiGHS).

    min t subject to the equalities, lower - t <= matrix z <= upper + t and t >= 0.
    """
    rows = rows_of(problem)
    size = rows.matrix.shape[1]
    at_upper, at_lower = np.isfinite(rows.upper), np.isfinite(rows.lower)
    inequality = np.vstack([rows.matrix[at_upper], -rows.matrix[at_lower]])
    bound = np.concatenate([rows.upper[at_upper], -rows.lower[at_lower]])
    equality = np.hstack([rows.equality, np.zeros((len(rows.value), 1))])
    found = linprog(
        np.append(np.zeros(size), 1.0),
        A_ub=np.hstack([inequality, -np.ones((len(bound), 1))]),
        b_ub=bound,
        A_eq=equality if len(equality) else None,
        b_eq=rows.value if len(equality) else None,
        bounds=[(None, None)] * size + [(0.0, None)],
        method="highs",
    )
    return bool(found.status == 0 and found.fun <= _FEASIBLE)

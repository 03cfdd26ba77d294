"""The smooth cascade under bounds: dense NumPy and the solver of the reference, no extension.

Each level is a QP over (u, q), x = x0 + Z (y + P u), f = f*(x) + F N q:

    min |A u - r|^2 + w_l |u|^2 + g^2 |q|^2  subject to all bounds,

g = 1 in the last level and 1e-4 above, where forces only have to be found. The bounds are those of
the problem, moved where the answer of the level above is at them up to the solvers' accuracy.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from reference.least_distance import least_squares
from reference.smooth_twin import (
    KD,
    Reduced,
    at_its_cost,
    level,
    reduced,
    rows_left,
    rows_of_levels,
    torque,
)

from ghc_controller.formulations import ControlProblem
from ghc_controller.types import Array

_UPPER_FORCE_WEIGHT = 1e-4  # [-] g
_KEPT = 2e-8  # [rad/s^2], [Nm], [N] by which the answer of a level lies inside for those below


class Answer(NamedTuple):
    """Answer of a mixture, blended, and what its levels met."""

    x: Array  # (n,) [rad/s^2]
    f: Array  # (c,) [N]
    torque: Array  # (a,) [Nm]
    qps: int  # levels whose optimum without bounds misses one, over all orders


class _Rows(NamedTuple):
    """All bounds as lower <= start + matrix (y, q) <= upper."""

    start: Array  # (r,)
    on_y: Array  # (r, d)
    on_q: Array  # (r, p)
    lower: Array  # (r,)
    upper: Array  # (r,)


def bounded_answer(problem: ControlProblem, slack: float = 0.0) -> Answer:
    """Answer without the torque rate limit; Infeasible where no point meets the bounds.

    Args:
        slack: [rad/s^2], [Nm], [N] by which every bound is wider.
    """
    x, f, qps = np.zeros(len(problem.bias)), np.zeros(len(reduced(problem).f0)), 0
    for index, candidate in enumerate(problem.priorities.candidates):
        own = at_its_cost(problem, index)
        terms = reduced(own)
        rows = _rows(own, terms)
        rows = rows._replace(lower=rows.lower - slack, upper=rows.upper + slack)
        own_x, own_f, own_qps = _of_order(own, terms, rows, candidate.alpha)
        x, f, qps = x + candidate.share * own_x, f + candidate.share * own_f, qps + own_qps
    return Answer(x, f, torque(problem, x, f), qps)


def _of_order(
    problem: ControlProblem, terms: Reduced, rows: _Rows, alpha: Array
) -> tuple[Array, Array, int]:
    Z, x0 = terms.Z, terms.x0
    J, b = rows_left(problem, terms)
    d, p = Z.shape[1], terms.free.shape[1]
    y, q, qps = Z.T @ (-KD * problem.velocity), np.zeros(p), 0
    above = np.zeros((0, d))
    lower, upper = rows.lower.copy(), rows.upper.copy()
    levels = rows_of_levels(problem, alpha)
    for index, chosen in enumerate(levels):
        A, damping, P = level(J[chosen], b[chosen], y, above)
        r = b[chosen] - J[chosen] @ y
        here = rows.start + rows.on_y @ y
        g = 1.0 if index + 1 == len(levels) else _UPPER_FORCE_WEIGHT
        u = A.T @ np.linalg.solve(A @ A.T + damping * np.eye(len(r)), r)
        q = np.zeros(p)
        reached = here + rows.on_y @ (P @ u)
        if np.any(reached < lower) or np.any(reached > upper):
            qps += 1
            cost = np.zeros((len(r) + d + p, d + p))
            cost[: len(r), :d] = A
            cost[len(r) : -p or None, :d] = np.sqrt(damping) * np.eye(d)
            cost[len(r) + d :, d:] = g * np.eye(p)
            wanted = np.append(r, np.zeros(d + p))
            G = np.hstack([rows.on_y @ P, rows.on_q])
            found = least_squares(
                cost,
                wanted,
                np.zeros((0, d + p)),
                np.zeros(0),
                np.vstack([G, -G]),
                np.append(lower - here, here - upper),
            ).z
            u, q = found[:d], found[d:]
            reached = here + G @ found
            lower, upper = np.minimum(lower, reached - _KEPT), np.maximum(upper, reached + _KEPT)
        y = y + P @ u
        above = np.vstack([above, J[chosen]])
    x = x0 + Z @ y
    return x, terms.f0 + terms.carry @ x + terms.free @ q, qps


def _rows(problem: ControlProblem, terms: Reduced) -> _Rows:
    """Box on x, torques, general rows and rows on forces."""
    u, n = problem.unactuated, len(problem.bias)
    contacts, general, c = problem.contacts, problem.rows, len(terms.f0)
    reach = np.zeros((c, n)) if contacts is None else contacts.force_jacobian
    box, limit = problem.acceleration, problem.torque_limit
    zero = np.zeros
    parts = [
        (np.eye(n), zero((n, c)), zero(n), box.lower, box.upper),
        (problem.mass_matrix[u:], -reach.T[u:], problem.bias[u:], limit.lower, limit.upper),
    ]
    if general is not None:
        r = len(general.lower)
        on_force = zero((r, c)) if general.force_matrix is None else general.force_matrix
        parts.append((general.matrix, on_force, zero(r), general.lower, general.upper))
    if contacts is not None:
        r = len(contacts.force_lower)
        bounds = (contacts.force_lower, contacts.force_upper)
        parts.append((zero((r, n)), contacts.force_matrix, zero(r), *bounds))
    on_x, on_f = (np.vstack([part[i] for part in parts]) for i in (0, 1))
    start, lower, upper = (np.concatenate([part[i] for part in parts]) for i in (2, 3, 4))
    with_forces = on_x + on_f @ terms.carry
    return _Rows(
        start + with_forces @ terms.x0 + on_f @ terms.f0,
        with_forces @ terms.Z,
        on_f @ terms.free,
        lower,
        upper,
    )

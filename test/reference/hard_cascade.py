"""Reference: null-space cascade of damped least squares with all bounds at every level.

Level l: min |J_l (x + Z u) - b_l|^2 + w |u|^2 over u and the contact forces, subject to all
bounds; then x += Z u and Z <- Z (null space of J_l Z, by SVD). It starts at y_0 = -kd v; with
contacts x = x_c + Z_c y, Z_c the null space of the motion rows, x_c their least solution, and
y_0 = Z_c^T (-kd v).

Choice for the forces: they cost nothing in the levels before the last (lexicographic order: a
proximal-point iteration drives their weight out of the answer), and
1/2 (f - f_0)^T H_f (f - f_0) stands beside 1/2 of the task cost in the last level.
It shares no module with src/.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from reference.least_distance import Array, Infeasible, Optimum, least_squares
from reference.plain import Contacts, Plain, violations

_RANK = 1e-8  # [-] of the largest singular value of J_l, null space between levels
_CONTACT_RANK = 1e-9  # [-] same, motion rows of contacts
_PROXIMAL = 1e-3  # [-] root of the weight on |f - f_k|^2 in N
_STILL = 1e-14  # [-] gradient that the proximal term may leave


class Reference(NamedTuple):
    """Answer of the cascade."""

    x: Array  # (n,) [rad/s^2]
    force: Array  # (c,) [N]
    torque: Array  # (a,) [Nm]
    residuals: Array  # (k,) |J_l x - b_l|
    answers: tuple[Array, ...]  # k times (n,): x after each level
    active: tuple[bool, ...]  # k entries: a bound holds the optimum of this level back
    violation: float  # largest over all rows, in their units
    kkt: float  # largest KKT residual of all QPs, in the whitened scale


Damping = Callable[[Array, Array, Array], float]


def kept_damping(w: float) -> Damping:
    """Damping of rows J (m, d), what the levels above leave, A (m, d), and r = b - J y (m,).

    w (1 - kept (1 - s)) + (1 - kept) min(|r|^2 / 200^2, 4 w), s = min(1, |J| / sqrt(m)), kept =
    |A|^2 / |J|^2: the rule of docs/architecture.md, written anew.
    """

    def damping(rows: Array, left: Array, residual: Array) -> float:
        size = float(np.linalg.norm(rows))
        kept = min(1.0, (float(np.linalg.norm(left)) / size) ** 2)
        length = min(1.0, size / np.sqrt(len(rows)))
        pull = min(float(residual @ residual) / 4e4, 4.0 * w)
        return w * (1.0 - kept * (1.0 - length)) + (1.0 - kept) * pull

    return damping


def hard_cascade(
    problem: Plain, w: float | Damping, kd: float = 0.0, velocity: Array | None = None
) -> Reference:
    """Solve all levels.

    Args:
        w: damping per level [-], or a rule for it. kd: [1/s].
        velocity: (n,) [rad/s], zero where not given.

    Raises:
        Infeasible: no point meets the bounds, the contacts and the balance.
    """
    n, contacts = len(problem.bias), problem.contacts
    start = np.zeros(n) if velocity is None else -kd * velocity
    if contacts is None:
        x, null = start, np.eye(n)
    else:
        x, null = _motion(contacts)
        x = x + null @ (null.T @ start)
    force = np.zeros(0) if contacts is None else contacts.center
    movable = null
    answers, active, kkt = [], [], 0.0
    for index, (jacobian, target) in enumerate(problem.levels):
        last = index == len(problem.levels) - 1
        if null.shape[1] == 0 and not (last and len(force)):
            answers.append(x)
            active.append(False)
            continue
        local = jacobian @ null
        residual = target - jacobian @ x
        damping = w(jacobian @ movable, local, residual) if callable(w) else w
        cost = np.vstack([local, np.sqrt(damping) * np.eye(null.shape[1])])
        wanted = np.append(residual, np.zeros(null.shape[1]))
        found, force = _level(problem, x, null, cost, wanted, force, index == 0, last)
        x = x + null @ found.z[: null.shape[1]]
        kkt = max(kkt, found.primal, found.dual, found.complementarity)
        answers.append(x)
        active.append(bool(np.any(found.multipliers > 1e-7)))
        null = null @ _null_space(local, _RANK * _largest(jacobian))
    misses = [np.linalg.norm(level.jacobian @ x - level.target) for level in problem.levels]
    return Reference(
        x,
        force,
        problem.torque(x, force),
        np.array(misses),
        tuple(answers),
        tuple(active),
        max(violations(problem, x, force)),
        kkt,
    )


def _level(
    problem: Plain,
    x: Array,
    null: Array,
    cost: Array,
    wanted: Array,
    force: Array,
    first: bool,
    last: bool,
) -> tuple[Optimum, Array]:
    """Optimum over (u, f) of |cost u - wanted|^2, and its forces (c,)."""
    c, d = len(force), null.shape[1]
    E, e, G, h = _rows(problem, x, null)
    if not first:  # the answer of the level above is feasible but for rounding
        here = np.append(np.zeros(d), force)
        h, e = np.minimum(h, G @ here), E @ here
    contacts = problem.contacts
    if contacts is None:
        found = least_squares(cost, wanted, E, e, G, h)
        return found, force
    if last:
        inverse = np.linalg.inv(contacts.factor)
        found = least_squares(*_beside(cost, wanted, inverse, contacts.center), E, e, G, h)
        return found, found.z[d:]
    for _ in range(100):
        found = least_squares(*_beside(cost, wanted, _PROXIMAL * np.eye(c), force), E, e, G, h)
        change = float(np.max(np.abs(found.z[d:] - force)))
        force = found.z[d:]
        if _PROXIMAL**2 * change <= _STILL:
            break
    left = _PROXIMAL**2 * change  # gradient of the exact cost with respect to f
    return found._replace(dual=max(found.dual, left)), force


def _beside(cost: Array, wanted: Array, weight: Array, center: Array) -> tuple[Array, Array]:
    """Least-squares rows of (u, f): cost u - wanted and weight (f - center)."""
    c = len(center)
    matrix = np.block([[cost, np.zeros((len(wanted), c))], [np.zeros((c, cost.shape[1])), weight]])
    return matrix, np.append(wanted, weight @ center)


def _rows(problem: Plain, x: Array, null: Array) -> tuple[Array, Array, Array, Array]:
    """E z = e (balance) and G z >= h (all bounds) on z = (u, f), at x + null u."""
    u, contacts = problem.unactuated, problem.contacts
    reach = problem.force_jacobian.T
    full = np.hstack([problem.mass @ null, -reach])
    bias = problem.mass @ x + problem.bias
    motion = np.hstack([null, np.zeros((len(x), reach.shape[1]))])
    blocks = [
        (motion, problem.lower - x, problem.upper - x),
        (full[u:], problem.torque_lower - bias[u:], problem.torque_upper - bias[u:]),
    ]
    if problem.rows is not None:
        matrix, lower, upper = problem.rows
        blocks.append((matrix @ motion, lower - matrix @ x, upper - matrix @ x))
    if contacts is not None:
        matrix, lower, upper = contacts.forces
        blocks.append((np.hstack([np.zeros((len(lower), null.shape[1])), matrix]), lower, upper))
    G = np.vstack([part for A, _, _ in blocks for part in (A, -A)])
    h = np.concatenate([part for _, low, high in blocks for part in (low, -high)])
    return full[:u], -bias[:u], G, h


def _motion(contacts: Contacts) -> tuple[Array, Array]:
    """Least x (n,) with J_c x = d and an orthonormal basis (n, d) of J_c x = 0."""
    left, sigma, right = np.linalg.svd(contacts.jacobian)
    rank = int(np.sum(sigma > _CONTACT_RANK * max(float(sigma[0]), 1e-300)))
    least = right[:rank].T @ ((left[:, :rank].T @ contacts.drift) / sigma[:rank])
    return least, right[rank:].T


def _null_space(rows: Array, tolerance: float) -> Array:
    _, sigma, right = np.linalg.svd(rows)
    return right[int(np.sum(sigma > tolerance)) :].T


def _largest(rows: Array) -> float:
    return max(float(np.linalg.norm(rows, 2)), 1e-300)


__all__ = ["Infeasible", "Reference", "hard_cascade"]

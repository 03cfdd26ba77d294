"""The smooth cascade without bounds in dense NumPy: no call of the extension, no QP.

What `docs/architecture.md` says of `cascade` and of contacts, with singular value decompositions
where the core reflects and projectors where it keeps rows.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ghc_controller.formulations import ControlProblem
from ghc_controller.types import Array, Bounds

W, E, KD = 1e-2, 3e-5, 20.0


def twin_answer(problem: ControlProblem) -> tuple[Array, Array, Array]:
    """x (n,), f (c,) and tau (a,) of a mixture of strict orders, blended."""
    parts = [
        (candidate.share, _of_order(at_its_cost(problem, index), candidate.alpha))
        for index, candidate in enumerate(problem.priorities.candidates)
    ]
    x, f, tau = (sum(share * answer[i] for share, answer in parts) for i in range(3))
    return np.asarray(x), np.asarray(f), np.asarray(tau)


def at_its_cost(problem: ControlProblem, index: int) -> ControlProblem:
    """The problem with the cost on forces that a candidate has for itself, if it has one."""
    contacts = problem.contacts
    if contacts is None or not contacts.of_candidates:
        return problem
    own = contacts.of_candidates[problem.priorities.candidates[index].alpha.tobytes()]
    contacts = contacts._replace(force_center=own.center, force_factor=own.factor)
    return replace(problem, contacts=contacts)


class Reduced(NamedTuple):
    """Accelerations x = x0 + Z y that contacts and balance leave, and the forces that carry them.

    f = f0 + carry x + free q: the least by its cost, and forces that leave the base alone.
    """

    x0: Array  # (n,)
    Z: Array  # (n, d)
    f0: Array  # (c,)
    carry: Array  # (c, n)
    free: Array  # (c, p)


def reduced(problem: ControlProblem) -> Reduced:
    """What contacts and the balance of the base leave of accelerations."""
    n, u, contacts = len(problem.bias), problem.unactuated, problem.contacts
    Z, x0, reach, f0, F = np.eye(n), np.zeros(n), np.zeros((0, n)), np.zeros(0), np.zeros((0, 0))
    if contacts is not None:
        x0, Z = _kept(contacts.jacobian, contacts.drift_target)
        reach, f0, F = contacts.force_jacobian, contacts.force_center, contacts.force_factor
    M, h = problem.mass_matrix, problem.bias
    on_base = reach[:, :u].T
    left, sigma, right = np.linalg.svd(on_base @ F, full_matrices=True)
    rank = int(np.sum(sigma > 1e-9 * sigma.max(initial=0.0)))
    N = left[:, rank:].T  # directions that no force carries: level 0
    more, inner = _kept(N @ M[:u] @ Z, -N @ (h[:u] + M[:u] @ x0))
    x0, Z = x0 + Z @ more, Z @ inner
    free = F @ right[rank:].T
    if not u:
        return Reduced(x0, Z, f0, np.zeros((len(f0), n)), free)
    least = F @ np.linalg.pinv(on_base @ F, rcond=1e-9)
    return Reduced(x0, Z, f0 + least @ (h[:u] - on_base @ f0), least @ M[:u], free)


def rows_left(problem: ControlProblem, terms: Reduced) -> tuple[Array, Array]:
    """J Z and b - J x0 (m,); rows that the contacts hold, to 1e-8 of their length, ask nothing."""
    J, b = problem.jacobian @ terms.Z, problem.target - problem.jacobian @ terms.x0
    left, length = (np.linalg.norm(rows, axis=1) for rows in (J, problem.jacobian))
    moves = left > 1e-8 * length if problem.contacts is not None else np.full(len(b), True)
    return np.where(moves[:, None], J, 0.0), np.where(moves, b, 0.0)


def _of_order(problem: ControlProblem, alpha: Array) -> tuple[Array, Array, Array]:
    terms = reduced(problem)
    Z, x0 = terms.Z, terms.x0
    J, b = rows_left(problem, terms)
    y = Z.T @ (-KD * problem.velocity)
    above = np.zeros((0, Z.shape[1]))
    for rows in rows_of_levels(problem, alpha):
        A, damping, P = level(J[rows], b[rows], y, above)
        r, m = b[rows] - J[rows] @ y, len(rows)
        y = y + P @ A.T @ np.linalg.solve(A @ A.T + damping * np.eye(m), r)
        above = np.vstack([above, J[rows]])
    x = x0 + Z @ y
    f = terms.f0 + terms.carry @ x
    return x, f, torque(problem, x, f)


def torque(problem: ControlProblem, x: Array, f: Array) -> Array:
    """tau (a,) [Nm] of accelerations (n,) and forces (c,)."""
    full = problem.mass_matrix @ x + problem.bias
    if problem.contacts is not None:
        full = full - problem.contacts.force_jacobian.T @ f
    return np.asarray(full[problem.unactuated :])


def rows_of_levels(problem: ControlProblem, alpha: Array) -> list[list[int]]:
    """Rows of the augmented Jacobian, level by level: how many are above a task is its place."""
    present = [task for task in range(len(alpha)) if alpha[task, task] == 0.0]
    above = alpha.sum(axis=1)
    return [
        [
            row
            for task in present
            if above[task] == place
            for row in range(problem.starts[task], problem.starts[task + 1])
        ]
        for place in sorted({above[task] for task in present})
    ]


def _kept(rows: Array, target: Array) -> tuple[Array, Array]:
    """Least x with rows x = target, and an orthonormal basis of rows x = 0."""
    _, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > 1e-9 * sigma.max(initial=0.0)))
    return np.linalg.pinv(rows, rcond=1e-9) @ target, right[rank:].T


def level(J: Array, b: Array, y: Array, above: Array) -> tuple[Array, float, Array]:
    """A = J P, w_l and P of a level that starts at y below the rows `above`.

    Without bounds its answer is c = y + P A^T (A A^T + w_l I)^-1 (b - J y).
    """
    e2 = E**2 * np.maximum(1.0, (above**2).sum(axis=1))
    _, sigma, right = np.linalg.svd(above / np.sqrt(e2)[:, None], full_matrices=False)
    P = np.eye(len(y)) - right.T @ ((sigma**2 / (1.0 + sigma**2))[:, None] * right)
    A, r, m = J @ P, b - J @ y, len(b)
    kept = min(1.0, float((A**2).sum() / max((J**2).sum(), 1e-300)))
    length = min(1.0, max(float(np.sqrt((J**2).sum() / max(m, 1))), 1e-4))
    damping = W * (1.0 - kept * (1.0 - length))
    damping += (1.0 - kept) * min(float(r @ r) / 100.0**2, 4.0 * W)
    return A, damping, P


def unbounded(problem: ControlProblem) -> ControlProblem:
    """The same problem without any bound."""

    def wide(size: int) -> Bounds:
        return Bounds(np.full(size, -np.inf), np.full(size, np.inf))

    n, a = len(problem.bias), len(problem.bias) - problem.unactuated
    contacts = problem.contacts
    if contacts is not None:
        forces = wide(len(contacts.force_lower))
        contacts = contacts._replace(force_lower=forces.lower, force_upper=forces.upper)
    joints = wide(a)
    return replace(
        problem, acceleration=wide(n), torque=joints, torque_limit=joints, contacts=contacts
    )


def apart(found: Array, wanted: Array) -> float:
    """Largest difference, relative to the largest entry and at least 1."""
    return float(np.abs(found - wanted).max(initial=0.0) / (1.0 + np.abs(wanted).max(initial=0.0)))

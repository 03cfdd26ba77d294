"""The smooth cascade without bounds in dense NumPy: no call of the extension, no QP.

What `docs/architecture.md` says of `cascade` and of contacts, with singular value decompositions
where the core reflects and projectors where it keeps rows.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations import ControlProblem
from ghc_controller.types import Array

W, E, KD = 1e-2, 3e-5, 20.0


def twin_answer(problem: ControlProblem) -> tuple[Array, Array, Array]:
    """x (n,), f (c,) and tau (a,) of a mixture of strict orders, blended."""
    parts = [
        (candidate.share, _of_order(problem, candidate.alpha))
        for candidate in problem.priorities.candidates
    ]
    x, f, tau = (sum(share * answer[i] for share, answer in parts) for i in range(3))
    return np.asarray(x), np.asarray(f), np.asarray(tau)


def _of_order(problem: ControlProblem, alpha: Array) -> tuple[Array, Array, Array]:
    n, u, contacts = len(problem.bias), problem.unactuated, problem.contacts
    Z, x0, reach, f0, F = np.eye(n), np.zeros(n), np.zeros((0, n)), np.zeros(0), np.zeros((0, 0))
    if contacts is not None:
        x0, Z = _kept(contacts.jacobian, contacts.drift_target)
        reach, f0, F = contacts.force_jacobian, contacts.force_center, contacts.force_factor
    M, h = problem.mass_matrix, problem.bias
    on_base = reach[:, :u].T
    left, sigma, _ = np.linalg.svd(on_base @ F, full_matrices=True)
    rank = int(np.sum(sigma > 1e-9 * sigma.max(initial=0.0)))
    N = left[:, rank:].T  # directions that no force carries: level 0
    more, inner = _kept(N @ M[:u] @ Z, -N @ (h[:u] + M[:u] @ x0))
    x0, Z = x0 + Z @ more, Z @ inner
    J, b = problem.jacobian @ Z, problem.target - problem.jacobian @ x0
    y = Z.T @ (-KD * problem.velocity)
    above = np.zeros((0, Z.shape[1]))
    for tasks in np.argsort(alpha.sum(axis=1)):  # strict: how many are above
        rows = slice(problem.starts[tasks], problem.starts[tasks + 1])
        y = _level(J[rows], b[rows], y, above)
        above = np.vstack([above, J[rows]])
    x = x0 + Z @ y
    needed = (M @ x + h)[:u] - on_base @ f0
    f = f0 + F @ (np.linalg.pinv(on_base @ F, rcond=1e-9) @ needed) if u else f0
    return x, f, (M @ x + h - reach.T @ f)[u:]


def _kept(rows: Array, target: Array) -> tuple[Array, Array]:
    """Least x with rows x = target, and an orthonormal basis of rows x = 0."""
    _, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > 1e-9 * sigma.max(initial=0.0)))
    return np.linalg.pinv(rows, rcond=1e-9) @ target, right[rank:].T


def _level(J: Array, b: Array, y: Array, above: Array) -> Array:
    """c = y + P A^T (A A^T + w_l I)^-1 (b - J y), A = J P."""
    e2 = E**2 * np.maximum(1.0, (above**2).sum(axis=1))
    P = np.eye(len(y)) - above.T @ np.linalg.solve(above @ above.T + np.diag(e2), above)
    A, r, m = J @ P, b - J @ y, len(b)
    kept = min(1.0, float((A**2).sum() / max((J**2).sum(), 1e-300)))
    length = min(1.0, max(float(np.sqrt((J**2).sum() / max(m, 1))), 1e-4))
    damping = W * (1.0 - kept * (1.0 - length))
    damping += (1.0 - kept) * min(float(r @ r) / 100.0**2, 4.0 * W)
    return np.asarray(y + P @ A.T @ np.linalg.solve(A @ A.T + damping * np.eye(m), r))

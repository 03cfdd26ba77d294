"""Steps of one level: bounded least squares in a null space, multipliers, square roots.

n coordinates, d dimensions left by the levels above, r rows of bounds.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.types import Array

_NO_ROW = 1e-8  # [-] bound rows shorter than this in the null space are ignored
_ROUNDING = 1e-8  # [rad], [m] largest violation of a solution
_LARGEST = 1e12  # [-] largest entry of an update: beyond it rounding dominates
_PIVOTS = 500
_SOLVED = 0


def bounded_level(
    rows: Array,
    right: Array,
    x: Array,
    null_space: Array,
    bounds: Array,
    lower: Array,
    upper: Array,
    regularization: float,
    tolerance: float,
) -> tuple[Array, bool, Array]:
    """min |A (x + N z) - b|^2 + rho |z|^2 subject to lower <= C (x + N z) <= upper.

    In the axes of the singular value decomposition of A N, scaled by 1 / sqrt(s^2 + rho), the
    cost is a constant plus 1/2 |u|^2: a projection of the free optimum. x must be feasible.

    Args:
        rows, right: A (k, n), b (k,). x: (n,). null_space: N (n, d), orthonormal columns.
        bounds, lower, upper: C (r, n), (r,).

    Returns:
        x + N z, whether it was solved (else x), null space left by A (n, d').
    """
    d = null_space.shape[1]
    U, s, Vt = np.linalg.svd(rows @ null_space, full_matrices=True)
    along = U.T @ (right - rows @ x)
    sizes = np.zeros(d)
    sizes[: len(s)] = s
    scale = 1.0 / np.sqrt(sizes * sizes + regularization)
    free = np.zeros(d)
    free[: len(s)] = (scale * sizes)[: len(s)] * along[: len(s)]
    rank = int(np.count_nonzero((s > 0.0) & (s > tolerance * s[:1])))
    moves = null_space @ Vt.T
    left = moves[:, rank:]
    unscaled = bounds @ moves
    moves = moves * scale
    reach = unscaled * scale
    now, start = bounds @ x, reach @ free
    low, high = np.minimum(lower - now, 0.0) - start, np.maximum(upper - now, 0.0) - start
    blind = np.einsum("rd,rd->r", unscaled, unscaled) < _NO_ROW * _NO_ROW
    low[blind], high[blind] = -np.inf, np.inf
    within = bool(np.all((low <= 0.0) & (high >= 0.0)))
    if within:
        return x + moves @ free, True, left
    status, _, u, _, _ = native.solve_dual(
        np.eye(d), np.zeros(d), np.zeros((0, d)), np.zeros(0), reach, low, high, _PIVOTS
    )
    if status != _SOLVED:  # rounding at a vertex of too many bounds looks infeasible
        reached = reach @ u
        if np.any((low - reached > _ROUNDING) | (reached - high > _ROUNDING)):
            return x.copy(), False, left
    return x + moves @ (free + u), True, left


def null_space_of(rows: Array, null_space: Array, tolerance: float) -> Array:
    """Orthonormal basis (n, d') of the null space of rows (k, n) within N (n, d)."""
    _, s, Vt = np.linalg.svd(rows @ null_space, full_matrices=True)
    rank = np.count_nonzero(s > tolerance * np.maximum(s[:1], 1e-300))
    return np.asarray(null_space @ Vt[rank:].T)


def multipliers(rows: Array, gradient: Array, free: Array) -> Array:
    """lambda (k,) of least norm with rows^T lambda = -gradient on the free coordinates.

    Args:
        rows: (k, n). gradient: (n,). free: (n,) 1 or 0, coordinates at a bound of the step are 0.
    """
    U, s, Vt = np.linalg.svd((rows * free).T, full_matrices=False)
    seen = s > 1e-9 * np.maximum(s[:1], 1e-300)
    along = np.where(seen, U.T @ (-gradient * free) / np.where(seen, s, 1.0), 0.0)
    return np.asarray(Vt.T @ along)


def positive_root(matrix: Array) -> Array:
    """R (k, n) with R^T R = the positive part of a symmetric matrix (n, n)."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    first = np.count_nonzero(values <= 1e-12)
    return np.asarray(np.sqrt(values[first:, None]) * vectors[:, first:].T)


def structured_update(B: Array, y: Array, step: Array, curvature: float) -> bool:
    """BFGS of B (n, n) in place, eq. 11.

    Returns False and changes nothing if y^T dq <= curvature or the update is too large.
    """
    along = y @ step
    moved = B @ step
    size = step @ moved
    if not (along > curvature and size > 1e-300 and (y @ y) < _LARGEST * along):
        return False
    B += np.outer(y, y) / along - np.outer(moved, moved) / size
    return True

"""Compiled steps of one level: bounded least squares in a null space, multipliers, square roots.

n coordinates, d dimensions left by the levels above, r rows of bounds.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.qp.dual_active_set import SOLVED, solve_dual
from ghc_controller.types import Array

_NO_ROW = 1e-8  # [-] a bound row shorter than this in the null space cannot be influenced
_ROUNDING = 1e-8  # [rad], [m] violation with which an answer still counts as solved
_LARGEST = 1e12  # [-] of what one update adds: beyond it rounding is all that is left
_PIVOTS = 500


@njit(cache=True)
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
) -> tuple[Array, bool, Array]:  # pragma: no cover
    """min |A (x + N z) - b|^2 + rho |z|^2 subject to lower <= C (x + N z) <= upper.

    In the axes of the singular value decomposition of A N, scaled by 1 / sqrt(s^2 + rho), the
    cost is a constant plus 1/2 |u|^2: the nearest point to the free optimum. x counts as feasible.

    Args:
        rows, right: A (k, n), b (k,). x: (n,). null_space: N (n, d), orthonormal columns.
        bounds, lower, upper: C (r, n), (r,).

    Returns:
        x + N z, whether it was solved (else x), null space left by A (n, d').
    """
    projected = np.ascontiguousarray(rows @ null_space)
    d = null_space.shape[1]
    U, s, Vt = np.linalg.svd(projected, full_matrices=True)
    along = U.T @ (right - rows @ x)
    rank = 0
    free, scale = np.zeros(d), np.empty(d)
    for i in range(d):
        size = s[i] if i < s.shape[0] else 0.0
        scale[i] = 1.0 / np.sqrt(size * size + regularization)
        if size > 0.0:
            free[i] = scale[i] * size * along[i]
            if size > tolerance * s[0]:
                rank += 1
    moves = np.ascontiguousarray(null_space @ Vt.T)
    left = np.ascontiguousarray(moves[:, rank:])
    moves = moves * scale
    reach = bounds @ moves
    now = bounds @ x
    count = bounds.shape[0]
    low, high = np.empty(count), np.empty(count)
    start = reach @ free
    within = True
    for i in range(count):
        low[i] = min(lower[i] - now[i], 0.0) - start[i]
        high[i] = max(upper[i] - now[i], 0.0) - start[i]
        length = 0.0
        for j in range(d):
            length += (reach[i, j] / scale[j]) ** 2
        if length < _NO_ROW * _NO_ROW:
            low[i], high[i] = -np.inf, np.inf
        elif low[i] > 0.0 or high[i] < 0.0:
            within = False
    if within:
        return x + moves @ free, True, left
    status, _, u, _, _ = solve_dual(
        np.eye(d), np.zeros(d), np.zeros((0, d)), np.zeros(0), reach, low, high, _PIVOTS
    )
    if status != SOLVED:  # at a vertex of more bounds than dimensions rounding looks infeasible
        reached = reach @ u
        for i in range(count):
            if low[i] - reached[i] > _ROUNDING or reached[i] - high[i] > _ROUNDING:
                return x.copy(), False, left
    return x + moves @ (free + u), True, left


@njit(cache=True)
def null_space_of(rows: Array, null_space: Array, tolerance: float) -> Array:  # pragma: no cover
    """Columns of N (n, d) that rows (k, n) do not see, orthonormal, (n, d')."""
    _, s, Vt = np.linalg.svd(np.ascontiguousarray(rows @ null_space), full_matrices=True)
    rank = 0
    for i in range(s.shape[0]):
        if s[i] > tolerance * max(s[0], 1e-300):
            rank += 1
    return np.ascontiguousarray(null_space @ np.ascontiguousarray(Vt[rank:].T))


@njit(cache=True)
def multipliers(rows: Array, gradient: Array, free: Array) -> Array:  # pragma: no cover
    """lambda (k,) of least norm with rows^T lambda = -gradient on the free coordinates.

    Args:
        rows: (k, n). gradient: (n,). free: (n,) 1 or 0, coordinates at a bound of the step are 0.
    """
    masked = np.ascontiguousarray((rows * free).T)
    U, s, Vt = np.linalg.svd(masked, full_matrices=False)
    along = U.T @ (-gradient * free)
    for i in range(s.shape[0]):
        along[i] = along[i] / s[i] if s[i] > 1e-9 * max(s[0], 1e-300) else 0.0
    return Vt.T @ along


@njit(cache=True)
def positive_root(matrix: Array) -> Array:  # pragma: no cover
    """R (k, n) with R^T R = the positive part of a symmetric matrix (n, n)."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    first = 0
    while first < values.shape[0] and values[first] <= 1e-12:
        first += 1
    root = np.ascontiguousarray(vectors[:, first:].T)
    for i in range(root.shape[0]):
        root[i] *= np.sqrt(values[first + i])
    return root


@njit(cache=True)
def structured_update(
    B: Array, y: Array, step: Array, curvature: float
) -> bool:  # pragma: no cover
    """BFGS of B (n, n) in place, eq. 11.

    False, without a change, where y^T dq <= curvature or the update is too large to be added.
    """
    along = y @ step
    moved = B @ step
    size = step @ moved
    if not (along > curvature and size > 1e-300 and (y @ y) < _LARGEST * along):
        return False
    for i in range(y.shape[0]):
        for j in range(y.shape[0]):
            B[i, j] += y[i] * y[j] / along - moved[i] * moved[j] / size
    return True

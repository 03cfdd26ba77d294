"""A hard null-space cascade in plain NumPy and SciPy, to compare formulations with.

Its QP is not one of the stack's solvers: least distance programming by non-negative least squares
(C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, chapter 23).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls

from ghc_controller.types import Array

_RANK = 1e-7  # [-] of the largest singular value of a level
_KEEP = 1e-9  # widening of bounds that keeps the answer of the level above feasible
_ACTIVE = 1e-11  # [-] multipliers above it belong to active rows
_NO_POINT = 1e-9  # [-] residual of the least squares below it: no feasible point
_MET = 1e-8  # rows of unit norm are met up to this


def bounded_least_squares(
    A: Array, r: Array, w: float, C: Array, lower: Array, upper: Array
) -> Array | None:
    """argmin |A z - r|^2 + w |z|^2 subject to lower <= C z <= upper; None if infeasible.

    A (m, n), r (m,), w > 0, C (p, n), bounds (p,) with +-inf where there is none.
    """
    n = A.shape[1]
    factor = cholesky(A.T @ A + w * np.eye(n), lower=True)  # H = L L^T, s = L^T z - L^-1 A^T r
    free = solve_triangular(factor, A.T @ r, lower=True)
    rows = solve_triangular(factor, C.T, lower=True).T  # C z = rows (s + free)
    at_lower, at_upper = np.isfinite(lower), np.isfinite(upper)
    G = np.vstack([rows[at_lower], -rows[at_upper]])
    h = np.concatenate([lower[at_lower], -upper[at_upper]]) - G @ free
    s = _least_distance(G, h)
    return None if s is None else solve_triangular(factor, s + free, lower=True, trans="T")


def _least_distance(G: Array, h: Array) -> Array | None:
    """argmin |s|^2 subject to G s >= h; None if infeasible."""
    norm = np.maximum(np.linalg.norm(G, axis=1), 1e-12)
    G, h = G / norm[:, None], h / norm
    scale = float(h.max(initial=0.0))
    if scale <= 0.0:
        return np.zeros(G.shape[1])
    h = h / scale
    goal = np.append(np.zeros(G.shape[1]), 1.0)
    stacked = np.vstack([G.T, h])
    multipliers, residual = nnls(stacked, goal, maxiter=100 * G.shape[0])
    if residual < _NO_POINT:
        return None
    active = multipliers > _ACTIVE * multipliers.max(initial=0.0)
    s = np.linalg.lstsq(G[active], h[active], rcond=None)[0]  # exact on the rows found active
    if (G @ s < h - _MET).any():  # the set was not found cleanly: the answer as it stands
        left = stacked @ multipliers - goal
        s = -left[:-1] / left[-1]
    return np.asarray(s * scale)


Damping = Callable[[Array, Array, Array], float]


def hard_cascade(
    jacobians: Sequence[Array],
    targets: Sequence[Array],
    w: float | Damping,
    C: Array,
    lower: Array,
    upper: Array,
) -> tuple[Array, Array] | None:
    """Lexicographic least squares, all bounds hard at every level, damped by w per level.

    w may be a rule for the damping, of the rows J, of what the levels above leave of them, and of
    the residual.

    Level l: min |J_l (x + Z u) - b_l|^2 + w |u|^2 subject to the bounds, then x += Z u and Z
    becomes the null space of all levels so far.

    Returns:
        x (n,) and the residual |J_l x - b_l| of every level; None when no x meets the bounds.
    """
    n = jacobians[0].shape[1]
    x, null, widened = np.zeros(n), np.eye(n), 0.0
    for J, b in zip(jacobians, targets, strict=True):
        if null.shape[1] == 0:
            break
        local, reached = J @ null, C @ x
        damping = w(J, local, b - J @ x) if callable(w) else w
        u = bounded_least_squares(
            local,
            b - J @ x,
            damping,
            C @ null,
            lower - reached - widened,
            upper - reached + widened,
        )
        if u is None:
            if widened == 0.0:
                return None
            break
        x, widened = x + null @ u, _KEEP
        _, sigma, right = np.linalg.svd(local)
        null = null @ right[int(np.sum(sigma > _RANK * max(sigma[0], 1e-300))) :].T
    residuals = [np.linalg.norm(J @ x - b) for J, b in zip(jacobians, targets, strict=True)]
    return x, np.array(residuals)

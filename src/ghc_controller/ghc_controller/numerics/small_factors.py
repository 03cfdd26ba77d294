"""Compiled linear algebra for the small matrices of a tick.

A plain loop is as quick as a call of LAPACK there, quicker where a matrix has the few rows of a
task; it takes seconds less to compile, and a singular matrix is no exception.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.types import Array

# Of numba's fast mathematics only what lets a sum be vectorised; NaN stays NaN.
REORDERED_SUMS = {"reassoc", "contract", "nsz"}

# A matrix singular to rounding gets a factor instead of an exception: a pivot that is no more than
# the rounding of its own diagonal entry is raised to that, and its column is dropped. Else the
# factor and its inverse grow from one such pivot to the next until they overflow.
_SMALLEST_PIVOT = 1e-15
_ROUNDING = 1e-14  # [-] of the diagonal entry


@njit(cache=True, fastmath=REORDERED_SUMS)
def cholesky(matrix: Array) -> Array:  # pragma: no cover
    """L (m, m), lower triangular, with L L^T = matrix; only its lower triangle is read."""
    m = matrix.shape[0]
    lower = np.zeros((m, m))
    kept = np.ones(m)  # 0 where the column is dropped
    for r in range(m):
        for c in range(r + 1):
            value = matrix[r, c]
            for e in range(c):
                value -= lower[r, e] * lower[c, e]
            if c < r:
                lower[r, c] = kept[c] * value / lower[c, c]
            else:
                least = max(_ROUNDING * matrix[r, r], _SMALLEST_PIVOT)
                kept[c] = 1.0 if value >= least else 0.0
                lower[r, c] = np.sqrt(max(value, least))
    return lower


@njit(cache=True, fastmath=REORDERED_SUMS)
def damped_factor(rows: Array, w: float) -> Array:  # pragma: no cover
    """L (m, m), lower triangular, with L L^T = J J^T + w I for rows J (m, d)."""
    m = rows.shape[0]
    gram = np.zeros((m, m))
    for r in range(m):
        gram[r, r] = w
        for c in range(r + 1):
            for d in range(rows.shape[1]):
                gram[r, c] += rows[r, d] * rows[c, d]
    return cholesky(gram)


@njit(cache=True)
def divide_rows(lower: Array, rows: Array) -> None:  # pragma: no cover
    """Overwrite rows (m, c) by L^-1 rows."""
    for r in range(rows.shape[0]):
        for p in range(r):
            for c in range(rows.shape[1]):
                rows[r, c] -= lower[r, p] * rows[p, c]
        scale = 1.0 / lower[r, r]
        for c in range(rows.shape[1]):
            rows[r, c] *= scale


@njit(cache=True)
def solve_factored(lower: Array, right: Array) -> Array:  # pragma: no cover
    """(L L^T)^-1 right, (m,)."""
    m = right.shape[0]
    x = right.copy()
    for r in range(m):
        for p in range(r):
            x[r] -= lower[r, p] * x[p]
        x[r] /= lower[r, r]
    for r in range(m - 1, -1, -1):
        for p in range(r + 1, m):
            x[r] -= lower[p, r] * x[p]
        x[r] /= lower[r, r]
    return x


@njit(cache=True)
def add_combination(weights: Array, rows: Array, out: Array) -> None:  # pragma: no cover
    """out (c,) += weights^T rows, of weights (m,) and rows (m, c)."""
    for r in range(rows.shape[0]):
        for c in range(rows.shape[1]):
            out[c] += weights[r] * rows[r, c]


@njit(cache=True)
def inverse_factor(matrix: Array) -> Array:  # pragma: no cover
    """F = L^-T (d, d) with matrix = L L^T, so that F F^T = matrix^-1."""
    d = matrix.shape[0]
    lower = cholesky(matrix)
    inverse = np.zeros((d, d))
    for r in range(d):  # forward substitution by rows; what lies right of the diagonal stays zero
        row = inverse[r]
        row[r] = 1.0
        for p in range(r):
            share, above = lower[r, p], inverse[p]
            for c in range(p + 1):
                row[c] -= share * above[c]
        scale = 1.0 / lower[r, r]
        for c in range(r + 1):
            row[c] *= scale
    return np.ascontiguousarray(inverse.T)


@njit(cache=True)
def invert(matrix: Array) -> bool:  # pragma: no cover
    """Overwrite a square matrix by its inverse (Gauss-Jordan, rows pivoted); False: singular."""
    d = matrix.shape[0]
    swapped = np.empty(d, dtype=np.int64)
    for p in range(d):
        best = p
        for r in range(p + 1, d):
            if abs(matrix[r, p]) > abs(matrix[best, p]):
                best = r
        if not abs(matrix[best, p]) > 0.0:
            return False
        swapped[p] = best
        for c in range(d):
            matrix[p, c], matrix[best, c] = matrix[best, c], matrix[p, c]
        scale = 1.0 / matrix[p, p]
        matrix[p, p] = 1.0
        for c in range(d):
            matrix[p, c] *= scale
        for r in range(d):
            if r != p:
                share = matrix[r, p]
                matrix[r, p] = 0.0
                for c in range(d):
                    matrix[r, c] -= share * matrix[p, c]
    for p in range(d - 1, -1, -1):
        for r in range(d):
            other = swapped[p]
            matrix[r, p], matrix[r, other] = matrix[r, other], matrix[r, p]
    return True

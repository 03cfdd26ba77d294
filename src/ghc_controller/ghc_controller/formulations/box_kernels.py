"""Compiled rows and checks of a box on accelerations and one on torques, without contacts.

Torques are tau = M x + h, M (a, d), h (a,); p variables s of the QP with x = x0 + F s.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.small_factors import REORDERED_SUMS
from ghc_controller.types import Array

_SMALLEST_NORM = 1e-9


@njit(cache=True, fastmath=REORDERED_SUMS)
def affine(matrix: Array, x: Array, offset: Array) -> Array:  # pragma: no cover
    """Matrix (r, d) times x plus offset (r,)."""
    result = np.empty(matrix.shape[0])
    for r in range(matrix.shape[0]):
        value = offset[r]
        for d in range(matrix.shape[1]):
            value += matrix[r, d] * x[d]
        result[r] = value
    return result


@njit(cache=True)
def is_inside(value: Array, lower: Array, upper: Array) -> bool:  # pragma: no cover
    """True where every entry lies between its bounds; False for NaN."""
    inside = True
    for r in range(value.shape[0]):
        inside = inside and lower[r] <= value[r] <= upper[r]
    return inside


@njit(cache=True)
def rows_inside(matrix: Array, x: Array, lower: Array, upper: Array) -> bool:  # pragma: no cover
    """True where lower <= matrix x <= upper, of rows (r, d); False for NaN."""
    return is_inside(affine(matrix, x, np.zeros(matrix.shape[0])), lower, upper)


@njit(cache=True)
def contact_answer(
    y: Array,
    force: Array,
    offset: Array,
    basis: Array,
    torque_matrix: Array,
    torque_offset: Array,
    torque_force: Array,
) -> tuple[Array, Array]:  # pragma: no cover
    """Accelerations (n,) and torques (a,) of reduced accelerations y (d,) and forces (c,)."""
    tau = affine(torque_force, force, affine(torque_matrix, y, torque_offset))
    return affine(basis, y, offset), tau


@njit(cache=True)
def torques_inside(
    x: Array,
    matrix: Array,
    offset: Array,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
) -> tuple[bool, Array]:  # pragma: no cover
    """Whether accelerations (d,) and their torques lie in both boxes; the torques (a,)."""
    tau = affine(matrix, x, offset)
    return is_inside(x, lower, upper) and is_inside(tau, tau_lower, tau_upper), tau


@njit(cache=True, fastmath=REORDERED_SUMS)
def normalize_rows(rows: Array, lower: Array, upper: Array) -> Array:  # pragma: no cover
    """Divide rows (r, p) and their bounds by the norms of the rows; the norms (r,)."""
    norm = np.empty(rows.shape[0])
    for r in range(rows.shape[0]):
        square = 0.0
        for c in range(rows.shape[1]):
            square += rows[r, c] * rows[r, c]
        norm[r] = max(np.sqrt(square), _SMALLEST_NORM)
        scale = 1.0 / norm[r]
        for c in range(rows.shape[1]):
            rows[r, c] *= scale
        lower[r] *= scale
        upper[r] *= scale
    return norm


@njit(cache=True)
def box_rows(
    x: Array,
    factor: Array,
    matrix: Array,
    offset: Array,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
) -> tuple[Array, Array, Array, Array]:  # pragma: no cover
    """Normalised rows on s of both boxes, (d + a, p), their bounds and their norms, (d + a,)."""
    d, p = factor.shape
    a = matrix.shape[0]
    rows = np.empty((d + a, p))
    of_torque = matrix @ factor
    for r in range(d + a):
        for c in range(p):
            rows[r, c] = factor[r, c] if r < d else of_torque[r - d, c]
    low, high = np.empty(d + a), np.empty(d + a)
    for r in range(d):
        low[r] = lower[r] - x[r]
        high[r] = upper[r] - x[r]
    tau = affine(matrix, x, offset)
    for r in range(a):
        low[d + r] = tau_lower[r] - tau[r]
        high[d + r] = tau_upper[r] - tau[r]
    return rows, low, high, normalize_rows(rows, low, high)


@njit(cache=True)
def is_outside(
    value: Array, lower: Array, upper: Array, tolerance: float
) -> bool:  # pragma: no cover
    """True where an entry lies outside its bounds by more than the tolerance."""
    outside = False
    for r in range(value.shape[0]):
        outside = outside or max(lower[r] - value[r], value[r] - upper[r]) > tolerance
    return outside

"""Compiled linear algebra of rigid contacts: motion that keeps them, and terms in what is left.

n velocity coordinates, q motion rows of the contacts, d = n - q accelerations that are left.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.numerics.small_factors import REORDERED_SUMS
from ghc_controller.types import Array

FIXED = 1e-8  # [-] of a task row's length: what is left of one that a contact holds
_DEPENDENT = 1e-4  # [-] of the largest pivot: a smaller one may stand for a row that depends


@njit(cache=True, fastmath=REORDERED_SUMS)
def null_motion_qr(rows: Array, target: Array) -> tuple[bool, Array, Array]:  # pragma: no cover
    """Least x (n,) with rows x = target, and an orthonormal basis (n, d) of rows x = 0.

    By Householder reflections of rows^T (q <= n); False where rows may depend on others.
    """
    q, n = rows.shape
    left = rows.copy()  # row k is column k of rows^T: left of k its triangle, then a reflector
    pivots, scales = np.empty(q), np.empty(q)
    for k in range(q):
        square = 0.0
        for c in range(k, n):
            square += left[k, c] * left[k, c]
        length = np.sqrt(square)
        pivots[k] = -length if left[k, k] > 0.0 else length
        left[k, k] -= pivots[k]
        norm = 2.0 * (square - pivots[k] * (left[k, k] + pivots[k]))
        scales[k] = 2.0 / norm if norm > 0.0 else 0.0
        for r in range(k + 1, q):
            _reflect(left[k], scales[k], k, left[r])
    least, basis = np.zeros(n), np.zeros((n - q, n))
    largest = np.max(np.abs(pivots)) if q else 0.0
    for k in range(q):
        if not abs(pivots[k]) > _DEPENDENT * largest:
            return False, least, basis.T.copy()
        value = target[k]
        for c in range(k):
            value -= left[k, c] * least[c]
        least[k] = value / pivots[k]
    for d in range(n - q):
        basis[d, q + d] = 1.0
    for k in range(q - 1, -1, -1):
        _reflect(left[k], scales[k], k, least)
        for d in range(n - q):
            _reflect(left[k], scales[k], k, basis[d])
    return True, least, basis.T.copy()


@njit(cache=True, fastmath=REORDERED_SUMS)
def _reflect(
    reflector: Array, scale: float, start: int, vector: Array
) -> None:  # pragma: no cover
    """Vector (n,) -= scale (r . vector) r, of the entries of r (n,) from `start` on."""
    share = 0.0
    for c in range(start, vector.shape[0]):
        share += reflector[c] * vector[c]
    share *= scale
    for c in range(start, vector.shape[0]):
        vector[c] -= share * reflector[c]


@njit(cache=True)
def reduced_terms(
    jacobian: Array,
    target: Array,
    mass_matrix: Array,
    bias: Array,
    force_jacobian: Array,
    offset: Array,
    basis: Array,
) -> tuple[Array, Array, Array, Array, Array]:  # pragma: no cover
    """Tasks and equation of motion in y, x = offset + basis y.

    Returns:
        J Z (m, d), b - J x_c (m,), M Z (n, d), h + M x_c (n,), -J_f^T (n, c).
    """
    reduced, left = jacobian @ basis, target - jacobian @ offset
    _clear_fixed_rows(jacobian, reduced, left)
    forces = np.ascontiguousarray(-force_jacobian.T)
    return reduced, left, mass_matrix @ basis, bias + mass_matrix @ offset, forces


@njit(cache=True)
def _clear_fixed_rows(before: Array, jacobian: Array, target: Array) -> None:  # pragma: no cover
    """Zero rows of which the contacts leave only rounding: noise is no direction to project on."""
    for r in range(before.shape[0]):
        whole, left = 0.0, 0.0
        for c in range(before.shape[1]):
            whole += before[r, c] * before[r, c]
        for c in range(jacobian.shape[1]):
            left += jacobian[r, c] * jacobian[r, c]
        if left <= FIXED * FIXED * whole:
            jacobian[r] = 0.0
            target[r] = 0.0

"""Compiled measurement of a frame: one call a task and tick, no temporaries."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from ghc_controller.numerics.rotation import (
    quaternion_conjugate,
    quaternion_from_matrix,
    quaternion_product,
    rotation_log,
)
from ghc_controller.types import Array


@numba.njit(cache=True, inline="always")
def orientation_error(reference: Array, rotation: Array) -> Array:
    """Rotation vector e (3,) with R_reference = exp(e) R, |e| <= pi; reference a quaternion."""
    actual = quaternion_from_matrix(rotation)
    return rotation_log(quaternion_product(reference, quaternion_conjugate(actual)))


@numba.njit(cache=True)
def frame_rows(
    rows: NDArray[np.int64],
    position: Array,
    rotation: Array,
    jacobian: Array,
    drift: Array,
    reference: Array,
    error_out: Array,
    jacobian_out: Array,
    drift_out: Array,
) -> None:
    """Write chosen rows of x, y, z, rx, ry, rz (0 to 5), positions first.

    reference: one number per position row, then a quaternion where there are rotation rows.
    """
    m = rows.shape[0]
    if rows[m - 1] >= 3:
        turn = orientation_error(reference[m - 3 :], rotation)
        for i in range(3):
            error_out[m - 3 + i] = turn[i]
    for i in range(m):
        row = rows[i]
        if row < 3:
            error_out[i] = reference[i] - position[row]
        drift_out[i] = drift[row]
        for j in range(jacobian.shape[1]):
            jacobian_out[i, j] = jacobian[row, j]

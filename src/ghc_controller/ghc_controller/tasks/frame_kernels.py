"""Compiled measurement of a frame: one call a task and tick, no temporaries."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from ghc_controller.numerics.rotation import (
    cross,
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


@numba.njit(cache=True)
def relative_terms(
    base_position: Array,
    base_rotation: Array,
    base_jacobian: Array,
    base_velocity: Array,
    base_drift: Array,
    position: Array,
    rotation: Array,
    jacobian: Array,
    velocity: Array,
    drift: Array,
    pose_out: Array,
    jacobian_out: Array,
    motion_out: Array,
) -> None:
    """Terms of a frame B as seen from a frame A, the base, in its axes; all inputs in the world's.

    With r = p_B - p_A and u = v_B - v_A - w_A x r, before they are turned by R_A^T,
    velocity = (u, w_B - w_A), drift = (a_B - a_A - b_A x r - w_A x (w_A x r) - 2 w_A x u,
    b_B - b_A - w_A x (w_B - w_A)), (a, b) the drift of a frame.
    pose_out: (4, 3) rotation, then position; motion_out: (2, 6) velocity, drift.
    """
    turn = base_rotation.T
    r = position - base_position
    w = base_velocity[3:]
    spin = velocity[3:] - w
    swept = cross(w, r)
    u = velocity[:3] - base_velocity[:3] - swept
    change = drift[:3] - base_drift[:3] - cross(base_drift[3:], r)
    change = change - cross(w, swept) - 2.0 * cross(w, u)
    turned = drift[3:] - base_drift[3:] - cross(w, spin)
    for i in range(3):
        pose_out[3, i] = 0.0
        motion_out[:, i] = 0.0
        motion_out[:, 3 + i] = 0.0
        for k in range(3):
            pose_out[3, i] += turn[i, k] * r[k]
            motion_out[0, i] += turn[i, k] * u[k]
            motion_out[0, 3 + i] += turn[i, k] * spin[k]
            motion_out[1, i] += turn[i, k] * change[k]
            motion_out[1, 3 + i] += turn[i, k] * turned[k]
        for j in range(3):
            pose_out[i, j] = 0.0
            for k in range(3):
                pose_out[i, j] += turn[i, k] * rotation[k, j]
    for j in range(jacobian.shape[1]):
        ax, ay, az = base_jacobian[3, j], base_jacobian[4, j], base_jacobian[5, j]
        x = jacobian[0, j] - base_jacobian[0, j] + r[1] * az - r[2] * ay
        y = jacobian[1, j] - base_jacobian[1, j] + r[2] * ax - r[0] * az
        z = jacobian[2, j] - base_jacobian[2, j] + r[0] * ay - r[1] * ax
        bx, by, bz = jacobian[3, j] - ax, jacobian[4, j] - ay, jacobian[5, j] - az
        for i in range(3):
            jacobian_out[i, j] = turn[i, 0] * x + turn[i, 1] * y + turn[i, 2] * z
            jacobian_out[3 + i, j] = turn[i, 0] * bx + turn[i, 1] * by + turn[i, 2] * bz

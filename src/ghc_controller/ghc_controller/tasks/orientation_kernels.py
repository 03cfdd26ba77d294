"""Compiled rows of orientation and pose tasks; see kernels.py for the conventions."""

from __future__ import annotations

import numba

from ghc_controller.numerics.rotation import (
    quaternion_conjugate,
    quaternion_from_matrix,
    quaternion_product,
    rotation_log,
)
from ghc_controller.types import Array


@numba.njit(cache=True, inline="always")
def orientation_error(reference: Array, rotation: Array) -> Array:
    """Rotation vector e (3,) in world axes with R_reference = exp(e) R, |e| <= pi."""
    actual = quaternion_from_matrix(rotation)
    return rotation_log(quaternion_product(reference, quaternion_conjugate(actual)))


@numba.njit(cache=True)
def orientation_rows(
    rotation: Array,
    jacobian: Array,
    velocity: Array,
    drift: Array,
    reference: Array,
    reference_velocity: Array,
    acceleration: Array,
    stiffness: Array,
    damping: Array,
    jacobian_out: Array,
    target_out: Array,
    error_out: Array,
) -> None:
    """Three angular rows from the angular parts of a frame's Jacobian, velocity and drift."""
    error = orientation_error(reference, rotation)
    for i in range(3):
        error_out[i] = error[i]
        target_out[i] = (
            acceleration[i]
            + stiffness[i] * error[i]
            + damping[i] * (reference_velocity[i] - velocity[3 + i])
            - drift[3 + i]
        )
        for j in range(jacobian.shape[1]):
            jacobian_out[i, j] = jacobian[3 + i, j]


@numba.njit(cache=True)
def pose_rows(
    position: Array,
    rotation: Array,
    jacobian: Array,
    velocity: Array,
    drift: Array,
    reference: Array,
    reference_velocity: Array,
    acceleration: Array,
    stiffness: Array,
    damping: Array,
    jacobian_out: Array,
    target_out: Array,
    error_out: Array,
) -> None:
    """Three position rows, then three orientation rows; reference: position, quaternion."""
    for i in range(3):
        error_out[i] = reference[i] - position[i]
    error_out[3:] = orientation_error(reference[3:], rotation)
    for i in range(6):
        target_out[i] = (
            acceleration[i]
            + stiffness[i] * error_out[i]
            + damping[i] * (reference_velocity[i] - velocity[i])
            - drift[i]
        )
        for j in range(jacobian.shape[1]):
            jacobian_out[i, j] = jacobian[i, j]

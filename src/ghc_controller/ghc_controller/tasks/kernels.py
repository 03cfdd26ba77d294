"""Compiled inner loops of the tasks: one call a task and tick, no temporaries.

Arguments named `*_out` are written. e = reference - actual; gains and references per row.
"""

from __future__ import annotations

import numba

from ghc_controller.types import Array


@numba.njit(cache=True)
def task_rows(
    jacobian: Array,
    drift: Array,
    error: Array,
    velocity_error: Array,
    acceleration: Array,
    stiffness: Array,
    damping: Array,
    jacobian_out: Array,
    target_out: Array,
    error_out: Array,
) -> None:
    """Write target = acceleration + stiffness e + damping e' - drift, with the rows beside it."""
    for i in range(error.shape[0]):
        error_out[i] = error[i]
        target_out[i] = (
            acceleration[i] + stiffness[i] * error[i] + damping[i] * velocity_error[i] - drift[i]
        )
        for j in range(jacobian.shape[1]):
            jacobian_out[i, j] = jacobian[i, j]


@numba.njit(cache=True)
def position_rows(
    position: Array,
    jacobian: Array,
    velocity: Array,
    drift: Array,
    axes: Array,
    reference: Array,
    reference_velocity: Array,
    acceleration: Array,
    stiffness: Array,
    damping: Array,
    jacobian_out: Array,
    target_out: Array,
    error_out: Array,
) -> None:
    """Rows of chosen world axes of a point; row i belongs to axis axes[i].

    position (3,); jacobian, velocity and drift have the linear rows first and may have more.
    """
    for i in range(axes.shape[0]):
        axis = axes[i]
        error = reference[i] - position[axis]
        error_out[i] = error
        target_out[i] = (
            acceleration[i]
            + stiffness[i] * error
            + damping[i] * (reference_velocity[i] - velocity[axis])
            - drift[axis]
        )
        for j in range(jacobian.shape[1]):
            jacobian_out[i, j] = jacobian[axis, j]


@numba.njit(cache=True)
def posture_rows(
    q: Array,
    v: Array,
    q_indices: Array,
    v_indices: Array,
    reference: Array,
    reference_velocity: Array,
    acceleration: Array,
    stiffness: Array,
    damping: Array,
    jacobian_out: Array,
    target_out: Array,
    error_out: Array,
) -> None:
    """Rows of chosen joints: a selection matrix, without drift."""
    for i in range(q_indices.shape[0]):
        error = reference[i] - q[q_indices[i]]
        error_out[i] = error
        target_out[i] = (
            acceleration[i]
            + stiffness[i] * error
            + damping[i] * (reference_velocity[i] - v[v_indices[i]])
        )
        for j in range(jacobian_out.shape[1]):
            jacobian_out[i, j] = 0.0
        jacobian_out[i, v_indices[i]] = 1.0

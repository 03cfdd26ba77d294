"""Compiled rows of the bounded QP where contacts or general rows take part.

n accelerations x = offset + basis y, d reduced ones y = y0 + F s, c contact forces f = f0 + G s,
a joints, p variables s, g general rows on x, r rows on f.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.problem.box_kernels import affine, normalize_rows
from ghc_controller.types import Array


@njit(cache=True)
def stacked_rows(
    basis: Array,
    offset: Array,
    y0: Array,
    factor: Array,
    f0: Array,
    force_factor: Array,
    lower: Array,
    upper: Array,
    general: Array,
    general_lower: Array,
    general_upper: Array,
    force_matrix: Array,
    force_lower: Array,
    force_upper: Array,
    torque_matrix: Array,
    torque_offset: Array,
    torque_force: Array,
    tau_lower: Array,
    tau_upper: Array,
) -> tuple[Array, Array, Array, Array]:  # pragma: no cover
    """Normalised rows on s, their bounds and norms: accelerations, general, forces, torques.

    basis (n, d); an empty one stands for the identity. general (g, n), force_matrix (r, c),
    torque_matrix (a, d) and torque_force (a, c) with tau = torque_matrix y + torque_offset +
    torque_force f; the other arrays are offsets and bounds of these.
    """
    n, p = lower.shape[0], factor.shape[1]
    first_force = n + general.shape[0]
    first_torque = first_force + force_matrix.shape[0]
    count = first_torque + torque_matrix.shape[0]
    rows, low, high = np.empty((count, p)), np.empty(count), np.empty(count)
    if basis.shape[0]:
        rows[:n] = basis @ factor
        x0 = affine(basis, y0, offset)
    else:
        rows[:n] = factor
        x0 = y0
    rows[n:first_force] = general @ rows[:n]
    rows[first_force:first_torque] = force_matrix @ force_factor
    rows[first_torque:] = torque_matrix @ factor + torque_force @ force_factor
    _shift(lower, upper, x0, low[:n], high[:n])
    value = affine(general, x0, np.zeros(general.shape[0]))
    _shift(general_lower, general_upper, value, low[n:first_force], high[n:first_force])
    value = affine(force_matrix, f0, np.zeros(force_matrix.shape[0]))
    _shift(
        force_lower,
        force_upper,
        value,
        low[first_force:first_torque],
        high[first_force:first_torque],
    )
    value = affine(torque_force, f0, affine(torque_matrix, y0, torque_offset))
    _shift(tau_lower, tau_upper, value, low[first_torque:], high[first_torque:])
    return rows, low, high, normalize_rows(rows, low, high)


@njit(cache=True)
def _shift(
    lower: Array, upper: Array, value: Array, low: Array, high: Array
) -> None:  # pragma: no cover
    """Bounds that are left where `value` is reached already."""
    for r in range(value.shape[0]):
        low[r] = lower[r] - value[r]
        high[r] = upper[r] - value[r]

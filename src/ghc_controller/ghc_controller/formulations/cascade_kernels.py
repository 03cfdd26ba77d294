"""Compiled steps of the smooth cascade: optimum of a level, and levels that need no QP.

d accelerations y, m rows of a level, A = J P its rows in the null space P of the levels above.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ghc_controller.formulations.box_kernels import affine, is_inside
from ghc_controller.hierarchy.soft_null_space import append_rows, project_rows
from ghc_controller.small_factors import add_combination, damped_factor, solve_factored
from ghc_controller.types import Array

BALANCED = 1e-6  # [N], [Nm] left of the equations of motion of the base

Levels = NDArray[np.int64]
# Basis (n, d; no rows = identity), offset (n,), torque matrix (a, d), torque offset (a,), torque
# force (a, c): what ReducedProblem says of x and tau.
Motion = tuple[Array, Array, Array, Array, Array]
# Center (c,), gain (c, u), residual (u,), balance matrix (u, d) and force (u, c): ForceCenter.
Balance = tuple[Array, Array, Array, Array, Array]
# General rows (g, n), rows on forces (r, c), and the bounds (n + a + g + r,) of x, tau and these.
Rows = tuple[Array, Array, Array, Array]
_SHORTEST = 1e-4  # [-] length of rows below which the damping falls no further
_LARGEST = 100.0  # [rad/s^2] that a level asks for along a direction that it is losing
_MOST = 4.0  # [-] of w that is added for it at most


@njit(cache=True)
def level_damping(
    jacobian: Array, rows: Array, residual: Array, w: float
) -> float:  # pragma: no cover
    """Damping of a level: rows J and what the levels above leave, A = J P, (m, d); r = b - J y.

    w (1 - kept (1 - s)) + (1 - kept) min(|r|^2 / (2 a)^2, 4 w), with kept = |A|^2 / |J|^2 and
    s = min(1, |J| / sqrt(m)). A task of short rows, such as a center of mass, keeps its gains as
    far as it keeps its directions. Along a direction that is being lost no level asks for more
    than |r| / (2 sqrt(w)): the second term brings that down to a while |r| is below 40 (rows in
    rad/s^2, m/s^2 and N count alike).
    """
    m = max(jacobian.shape[0], 1)
    whole = np.sum(jacobian * jacobian)
    kept = min(1.0, np.sum(rows * rows) / max(whole, 1e-300))
    length = min(1.0, max(np.sqrt(whole / m), _SHORTEST))
    pull = np.sum(residual * residual) / (4.0 * _LARGEST * _LARGEST)
    return w * (1.0 - kept * (1.0 - length)) + (1.0 - kept) * min(pull, _MOST * w)


@njit(cache=True)
def level_optimum(
    jacobian: Array, target: Array, y: Array, basis: Array, used: int, w: float
) -> tuple[Array, Array, float]:  # pragma: no cover
    """c = y + P A^T (A A^T + w_l I)^-1 (b - J y), (d,), A (m, d) and the damping w_l."""
    rows = project_rows(jacobian, basis, used)
    residual = target - affine(jacobian, y, np.zeros(jacobian.shape[0]))
    damping = level_damping(jacobian, rows, residual, w)
    step = np.zeros(y.shape[0])
    add_combination(solve_factored(damped_factor(rows, damping), residual), rows, step)
    return y + project_rows(step.reshape(1, -1), basis, used)[0], rows, damping


@njit(cache=True)
def free_levels(
    jacobian: Array,
    target: Array,
    ends: Levels,
    first: int,
    y: Array,
    basis: Array,
    used: int,
    w: float,
    e: float,
    motion: Motion,
    balance: Balance,
    bounds: Rows,
) -> tuple[int, int, Array, Array, Array, Array]:  # pragma: no cover
    """Levels from `first` on as long as the optimum of each meets every bound.

    Rows (m, d) and targets (m,) stand in the order of the levels, that of level l ends at
    ends[l]. `used` rows of `basis` hold the levels before `first`.

    Returns:
        The first level that meets a bound (or how many there are), rows used of `basis` before
        it, and of the level before it y (d,), x (n,), torques (a,) and forces (c,).
    """
    force = balance[0]
    x, tau = y, y
    for level in range(first, ends.shape[0]):
        begin = ends[level - 1] if level else 0
        rows = jacobian[begin : ends[level]]
        better = level_optimum(rows, target[begin : ends[level]], y, basis, used, w)[0]
        fine, x_of, tau_of, force_of = _inside(better, motion, balance, bounds)
        if not fine:
            return level, used, y, x, tau, force
        y, x, tau, force = better, x_of, tau_of, force_of
        if level + 1 < ends.shape[0]:
            used = append_rows(rows, e, basis, used)
    return ends.shape[0], used, y, x, tau, force


@njit(cache=True)
def _inside(
    y: Array, motion: Motion, balance: Balance, bounds: Rows
) -> tuple[bool, Array, Array, Array]:  # pragma: no cover
    """Whether y (d,) and the forces that balance it meet every bound; x, torques and forces."""
    whole, offset, torque_matrix, torque_offset, torque_force = motion
    center, gain, residual, balance_matrix, balance_force = balance
    general, force_matrix, lower, upper = bounds
    x = affine(whole, y, offset) if whole.shape[0] else y
    force, balanced = center, True
    if residual.shape[0]:
        left = residual - affine(balance_matrix, y, np.zeros(residual.shape[0]))
        force = affine(gain, left, center)
        carried = affine(balance_force, force - center, np.zeros(residual.shape[0]))
        balanced = np.max(np.abs(left - carried)) <= BALANCED
    tau = affine(torque_matrix, y, torque_offset)
    if force.shape[0]:
        tau = affine(torque_force, force, tau)
    n, a, g = x.shape[0], tau.shape[0], general.shape[0]
    fine = balanced and is_inside(x, lower[:n], upper[:n])
    fine = fine and is_inside(tau, lower[n : n + a], upper[n : n + a])
    if fine and g:
        value = affine(general, x, np.zeros(g))
        fine = is_inside(value, lower[n + a : n + a + g], upper[n + a : n + a + g])
    if fine and force_matrix.shape[0]:
        push = affine(force_matrix, force, np.zeros(force_matrix.shape[0]))
        fine = is_inside(push, lower[n + a + g :], upper[n + a + g :])
    return fine, x, tau, force

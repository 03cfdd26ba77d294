"""Compiled steps of the smooth cascade: optimum of a level, and levels that need no QP.

d accelerations y, m rows of a level, A = J P its rows in the null space P of the levels above.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.formulations.box_kernels import affine, is_inside
from ghc_controller.hierarchy.soft_null_space import append_rows, project_rows
from ghc_controller.small_factors import add_combination, damped_factor, solve_factored
from ghc_controller.types import Array

_SHORTEST = 1e-4  # [-] mean square length of rows below which the damping falls no further


@njit(cache=True)
def level_damping(jacobian: Array, rows: Array, w: float) -> float:  # pragma: no cover
    """Damping of a level with rows J and what the levels above leave of them, A = J P; (m, d).

    w (1 - kept (1 - s)) with s = min(1, |J|^2 / m) and kept = |A|^2 / |J|^2: a task of short rows,
    such as a center of mass, keeps its gains as far as it keeps its directions, and directions
    that are lost to levels above are damped by w.
    """
    m = jacobian.shape[0]
    whole = np.sum(jacobian * jacobian)
    if not whole > _SHORTEST * m:
        return w
    return w * (1.0 - min(1.0, np.sum(rows * rows) / whole) * (1.0 - min(1.0, whole / m)))


@njit(cache=True)
def level_optimum(
    jacobian: Array, target: Array, y: Array, basis: Array, used: int, w: float
) -> tuple[Array, Array, float]:  # pragma: no cover
    """c = y + P A^T (A A^T + w_l I)^-1 (b - J y), (d,), A (m, d) and the damping w_l."""
    rows = project_rows(jacobian, basis, used)
    damping = level_damping(jacobian, rows, w)
    residual = target - affine(jacobian, y, np.zeros(jacobian.shape[0]))
    step = np.zeros(y.shape[0])
    add_combination(solve_factored(damped_factor(rows, damping), residual), rows, step)
    return y + project_rows(step.reshape(1, -1), basis, used)[0], rows, damping


@njit(cache=True)
def free_levels(
    jacobian: Array,
    target: Array,
    ends: Array,
    first: int,
    y: Array,
    basis: Array,
    used: int,
    w: float,
    e: float,
    matrix: Array,
    offset: Array,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
    general: Array,
    general_lower: Array,
    general_upper: Array,
) -> tuple[int, int, Array, Array]:  # pragma: no cover
    """Levels from `first` on as long as the optimum of each meets every bound of a fixed base.

    Rows (m, d) and targets (m,) stand in the order of the levels, that of level l ends at
    ends[l]. Torques are matrix y + offset.

    Returns:
        Level that meets a bound (or how many there are), rows used of `basis` before it, y (d,)
        of the level before it, and its torques (a,).
    """
    tau = affine(matrix, y, offset)
    for level in range(first, ends.shape[0]):
        begin = ends[level - 1] if level else 0
        rows = jacobian[begin : ends[level]]
        better = level_optimum(rows, target[begin : ends[level]], y, basis, used, w)[0]
        torque = affine(matrix, better, offset)
        if not (
            is_inside(better, lower, upper)
            and is_inside(torque, tau_lower, tau_upper)
            and is_inside(
                affine(general, better, np.zeros(general.shape[0])), general_lower, general_upper
            )
        ):
            return level, used, y, tau
        y, tau = better, torque
        if level + 1 < ends.shape[0]:
            used = append_rows(rows, e, basis, used)
    return ends.shape[0], used, y, tau

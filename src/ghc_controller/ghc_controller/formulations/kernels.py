"""Compiled inner loops of the projector formulations: their targets, metrics and systems.

Letters: J_i, b_i rows of task i; P_i its generalized projector; w the regularisation; k tasks,
m rows, d (reduced) accelerations.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.hierarchy.directions import Starts, selected_values
from ghc_controller.hierarchy.projector import write_projectors
from ghc_controller.numerics.small_factors import (
    add_combination,
    cholesky,
    damped_factor,
    divide_rows,
    invert,
    solve_factored,
)
from ghc_controller.types import Array


@njit(cache=True)
def ghc_target(
    jacobian: Array,
    target: Array,
    starts: Starts,
    alpha: Array,
    w: float,
    rank_tolerance: float,
    layer_damping: float,
) -> tuple[Array, Array]:  # pragma: no cover
    """x0 = sum_i (J_i P_i)^T (J_i J_i^T + w I)^-1 b_i, (d,), and the projectors (k, d, d)."""
    k, d = alpha.shape[0], jacobian.shape[1]
    projectors = np.empty((k, d, d))
    write_projectors(jacobian, starts, alpha, rank_tolerance, layer_damping, projectors)
    x0 = np.zeros(d)
    for i in range(k):
        rows = jacobian[starts[i] : starts[i + 1]]
        desired = target[starts[i] : starts[i + 1]]
        alone = np.zeros(d)  # J_i^T (J_i J_i^T + w I)^-1 b_i
        is_selection, values = selected_values(rows)
        if is_selection:
            add_combination(desired, rows, alone)
            for c in range(d):
                alone[c] /= values[c] * values[c] + w
        else:
            add_combination(solve_factored(damped_factor(rows, w), desired), rows, alone)
        add_combination(alone, projectors[i], x0)
    return x0, projectors


@njit(cache=True)
def ghc_factor(
    jacobian: Array,
    starts: Starts,
    alpha: Array,
    projectors: Array,
    w: float,
    layer_damping: float,
) -> Array:  # pragma: no cover
    """Cholesky factor L (d, d) of G = sum P_i P_i - (J_i P_i)^T (J_i J_i^T + w I)^-1 (J_i P_i)."""
    k, d = projectors.shape[0], projectors.shape[1]
    metric = np.zeros((d, d))
    for i in range(k):
        projection = projectors[i]
        is_strict = layer_damping == 0.0
        for j in range(k):
            is_strict = is_strict and (alpha[i, j] == 0.0 or alpha[i, j] == 1.0)
        rows = jacobian[starts[i] : starts[i + 1]]
        is_selection, values = selected_values(rows)
        if is_selection:  # P_i D P_i with the diagonal matrix D = I - J^T (J J^T + w I)^-1 J
            left_over = w / (values * values + w)
            if is_strict and np.min(left_over) == np.max(left_over):
                metric += left_over[0] * projection
            else:
                metric += projection @ (left_over.reshape(d, 1) * projection)
        else:
            metric += projection if is_strict else projection @ projection  # P P = P if strict
            projected = rows @ projection
            divide_rows(damped_factor(rows, w), projected)
            metric -= projected.T @ projected
    for r in range(d):
        metric[r, r] += 1e-15
    return cholesky(metric)


@njit(cache=True)
def balanced_system(
    jacobian: Array,
    starts: Starts,
    alpha: Array,
    w: float,
    rank_tolerance: float,
    layer_damping: float,
) -> tuple[Array, Array]:  # pragma: no cover
    """A = sum P_i J_i^T J_i + w I (d, d), and the projectors (k, d, d)."""
    k, d = alpha.shape[0], jacobian.shape[1]
    projectors = np.empty((k, d, d))
    write_projectors(jacobian, starts, alpha, rank_tolerance, layer_damping, projectors)
    system = np.zeros((d, d))
    for r in range(d):
        system[r, r] = w
    for i in range(k):
        if alpha[i, i] >= 1.0:
            continue  # removed: P_i J_i^T = 0
        rows = jacobian[starts[i] : starts[i + 1]]
        is_selection, values = selected_values(rows)
        if is_selection:
            system += projectors[i] * (values * values)
        else:
            system += (rows @ projectors[i]).T @ rows
    return system, projectors


@njit(cache=True)
def balanced_target(
    jacobian: Array,
    target: Array,
    starts: Starts,
    alpha: Array,
    w: float,
    rank_tolerance: float,
    layer_damping: float,
    guard: float,
) -> tuple[Array, float]:  # pragma: no cover
    """x* (d,) of A x* = sum P_i J_i^T b_i (`balanced_system`), and a bound on sigma_min(A).

    A is not symmetric: intransitive priority networks can bring it near singularity. Below
    `guard` (on 1 / |A^-1|_F <= sigma_min) a damping enters that grows from zero, so that x* stays
    bounded.
    """
    d = jacobian.shape[1]
    system, projectors = balanced_system(jacobian, starts, alpha, w, rank_tolerance, layer_damping)
    right = np.zeros(d)
    for i in range(alpha.shape[0]):
        if alpha[i, i] < 1.0:
            pull = np.zeros(d)
            rows = jacobian[starts[i] : starts[i + 1]]
            add_combination(target[starts[i] : starts[i + 1]], rows, pull)
            add_combination(pull, projectors[i], right)
    inverse = system.copy()
    sigma = 0.0
    if invert(inverse):
        sigma = 1.0 / np.sqrt(np.sum(inverse * inverse))
    if sigma >= guard:
        return inverse @ right, sigma
    normal = system.T @ system
    for r in range(d):
        normal[r, r] += guard * guard - sigma * sigma
    return solve_factored(cholesky(normal), system.T @ right), sigma

"""Compiled inner loops of the formulations: projected targets, metrics, bound checks.

Letters: J_i, b_i rows of task i; P_i its generalized projector; w the regularisation; k tasks,
m rows, d (reduced) accelerations.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.hierarchy.projector import Starts, projector
from ghc_controller.types import Array


@njit(cache=True)
def _damped_gram(rows: Array, w: float) -> Array:  # pragma: no cover
    gram = rows @ rows.T
    for r in range(gram.shape[0]):
        gram[r, r] += w
    return gram


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
    x0 = np.zeros(d)
    for i in range(k):
        projector(jacobian, starts, alpha[i], rank_tolerance, layer_damping, projectors[i])
        if starts[i + 1] > starts[i]:
            rows = jacobian[starts[i] : starts[i + 1]]
            scaled = np.linalg.solve(_damped_gram(rows, w), target[starts[i] : starts[i + 1]])
            x0 += projectors[i] @ (rows.T @ scaled)
    return x0, projectors


@njit(cache=True)
def ghc_factor(
    jacobian: Array, starts: Starts, projectors: Array, w: float
) -> Array:  # pragma: no cover
    """Cholesky factor L (d, d) of G = sum P_i P_i - (J_i P_i)^T (J_i J_i^T + w I)^-1 (J_i P_i)."""
    k, d = projectors.shape[0], jacobian.shape[1]
    metric = np.zeros((d, d))
    for i in range(k):
        metric += projectors[i] @ projectors[i]
        if starts[i + 1] > starts[i]:
            rows = jacobian[starts[i] : starts[i + 1]]
            projected = rows @ projectors[i]
            metric -= projected.T @ np.linalg.solve(_damped_gram(rows, w), projected)
    metric = 0.5 * (metric + metric.T)
    for r in range(d):
        metric[r, r] += 1e-15
    return np.linalg.cholesky(metric)


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
    """x* (d,) of [sum P_i J_i^T J_i + w I] x* = sum P_i J_i^T b_i, and a bound on sigma_min.

    The system is not symmetric: intransitive priority networks can bring it near singularity.
    Below `guard` (on 1 / |A^-1|_F <= sigma_min) a damping enters that grows from zero, so that
    x* stays bounded and continuous.
    """
    k, d = alpha.shape[0], jacobian.shape[1]
    system = np.zeros((d, d))
    right = np.zeros(d)
    projection = np.empty((d, d))
    for r in range(d):
        system[r, r] = w
    for i in range(k):
        if alpha[i, i] >= 1.0 or starts[i + 1] == starts[i]:
            continue  # removed: P_i J_i^T = 0
        rows = jacobian[starts[i] : starts[i + 1]]
        projector(jacobian, starts, alpha[i], rank_tolerance, layer_damping, projection)
        projected = projection @ np.ascontiguousarray(rows.T)
        system += projected @ rows
        right += projected @ target[starts[i] : starts[i + 1]]
    inverse = np.linalg.inv(system)
    sigma = 1.0 / np.sqrt(np.sum(inverse * inverse))
    if sigma >= guard:
        return inverse @ right, sigma
    normal = system.T @ system
    for r in range(d):
        normal[r, r] += guard * guard - sigma * sigma
    return np.linalg.solve(normal, system.T @ right), sigma


@njit(cache=True)
def priority_weights(alpha: Array, ratio: float) -> Array:  # pragma: no cover
    """gamma_i = (1 - alpha_ii) ratio^(s_i), s_i = sum_j alpha_ji over active j != i; (k,)."""
    k = alpha.shape[0]
    weights = np.zeros(k)
    for i in range(k):
        dominated = 0.0
        for j in range(k):
            if j != i:
                dominated += (1.0 - alpha[j, j]) * alpha[j, i]
        weights[i] = (1.0 - alpha[i, i]) * ratio**dominated
    return weights


@njit(cache=True)
def weighted_system(
    jacobian: Array, target: Array, starts: Starts, weights: Array, damping: float
) -> tuple[Array, Array]:  # pragma: no cover
    """H = sum_i weights_i J_i^T J_i + damping I, (d, d), and sum_i weights_i J_i^T b_i, (d,)."""
    d = jacobian.shape[1]
    hessian = np.zeros((d, d))
    right = np.zeros(d)
    for r in range(d):
        hessian[r, r] = damping
    for i in range(weights.shape[0]):
        if weights[i] > 0.0 and starts[i + 1] > starts[i]:
            rows = jacobian[starts[i] : starts[i + 1]]
            scaled = weights[i] * rows
            hessian += scaled.T @ rows
            right += scaled.T @ target[starts[i] : starts[i + 1]]
    return hessian, right


@njit(cache=True)
def inverse_factor(matrix: Array) -> Array:  # pragma: no cover
    """F = L^-T (d, d) with matrix = L L^T, so that F F^T = matrix^-1."""
    lower = np.linalg.cholesky(matrix)
    return np.ascontiguousarray(np.linalg.solve(lower, np.eye(matrix.shape[0])).T)


@njit(cache=True)
def meets_boxes(
    x: Array,
    tau: Array,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
) -> bool:  # pragma: no cover
    """True where accelerations and torques lie inside both boxes."""
    for d in range(x.shape[0]):
        if not (lower[d] <= x[d] <= upper[d]):
            return False
    for d in range(tau.shape[0]):  # noqa: SIM110 - compiled
        if not (tau_lower[d] <= tau[d] <= tau_upper[d]):
            return False
    return True

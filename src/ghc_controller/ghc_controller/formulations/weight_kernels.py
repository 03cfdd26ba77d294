"""Compiled weights of tasks by priority, and the least-squares system that they make.

Letters: J_i, b_i rows of task i; k tasks, m rows, d (reduced) accelerations.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ghc_controller.hierarchy.directions import Starts, selected_values
from ghc_controller.numerics.small_factors import add_combination
from ghc_controller.types import Array


@njit(cache=True)
def priority_weights(alpha: Array, ratio: float, spread: float) -> Array:  # pragma: no cover
    """gamma_i = (1 - alpha_ii) r^(s_i), s_i = sum_j alpha_ji over active j != i; (k,).

    r is `ratio`, or less where many tasks are in: no gamma_i exceeds `spread`. Continuous in
    alpha, since the largest s_i is.
    """
    k = alpha.shape[0]
    dominated = np.zeros(k)
    longest = 1.0
    for i in range(k):
        for j in range(k):
            if j != i:
                dominated[i] += (1.0 - alpha[j, j]) * alpha[j, i]
        longest = max(longest, dominated[i])
    base = min(ratio, spread ** (1.0 / longest))
    weights = np.zeros(k)
    for i in range(k):
        weights[i] = (1.0 - alpha[i, i]) * base ** dominated[i]
    return weights


@njit(cache=True)
def weighted_system(
    jacobian: Array,
    target: Array,
    starts: Starts,
    alpha: Array,
    ratio: float,
    spread: float,
    damping: float,
) -> tuple[Array, Array]:  # pragma: no cover
    """H = sum_i gamma_i J_i^T J_i + damping I, (d, d), and sum_i gamma_i J_i^T b_i, (d,).

    The weights gamma_i are `priority_weights` with this ratio and spread.
    """
    d = jacobian.shape[1]
    weights = priority_weights(alpha, ratio, spread)
    hessian = np.zeros((d, d))
    right = np.zeros(d)
    for r in range(d):
        hessian[r, r] = damping
    for i in range(weights.shape[0]):
        if weights[i] > 0.0:
            rows = jacobian[starts[i] : starts[i + 1]]
            is_selection, values = selected_values(rows)
            if is_selection:
                for r in range(d):
                    hessian[r, r] += weights[i] * values[r] * values[r]
            else:
                hessian += (weights[i] * rows).T @ rows
            add_combination(weights[i] * target[starts[i] : starts[i + 1]], rows, right)
    return hessian, right

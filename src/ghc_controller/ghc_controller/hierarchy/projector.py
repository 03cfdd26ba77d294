"""Generalized projectors of the GHC paper (algorithms 1 and 2), compiled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ghc_controller.types import Array

Starts = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class ProjectorSettings:
    """How linear dependence between task rows is decided."""

    rank_tolerance: float = 1e-7  # [-] of a row's norm: what is left of it counts as a direction
    layer_damping: float = 0.0  # [-] e > 0: damped layers, continuous in q where the rank changes


@njit(cache=True)
def descending_order(alpha_row: Array) -> NDArray[np.int64]:  # pragma: no cover
    """Task indices by descending priority over one task; ties keep their order."""
    k = alpha_row.shape[0]
    order = np.arange(k)
    for a in range(1, k):
        current = order[a]
        b = a - 1
        while b >= 0 and alpha_row[order[b]] < alpha_row[current]:
            order[b + 1] = order[b]
            b -= 1
        order[b + 1] = current
    return order


@njit(cache=True)
def exact_projector(
    jacobian: Array, starts: Starts, alpha_row: Array, rank_tolerance: float, out: Array
) -> None:  # pragma: no cover
    """P_i = I - B^T A^{r,s} B (eq. 11) by two-pass Gram-Schmidt; writes the (n, n) `out`.

    Rows of tasks with alpha = 0 come last and enter with coefficient 0: they are not looked at.
    """
    n = jacobian.shape[1]
    out[:, :] = 0.0
    for d in range(n):
        out[d, d] = 1.0
    basis = np.empty((n, n))
    rank = 0
    for task in descending_order(alpha_row):
        weight = alpha_row[task]
        if weight <= 0.0 or rank >= n:
            break
        for row in range(starts[task], starts[task + 1]):
            if rank >= n:
                break
            direction = basis[rank]
            norm_before = 0.0
            for d in range(n):
                direction[d] = jacobian[row, d]
                norm_before += direction[d] * direction[d]
            norm_before = np.sqrt(norm_before)
            for _ in range(2):  # the second pass removes the rounding of the first
                for b in range(rank):
                    dot = 0.0
                    for d in range(n):
                        dot += direction[d] * basis[b, d]
                    for d in range(n):
                        direction[d] -= dot * basis[b, d]
            norm = 0.0
            for d in range(n):
                norm += direction[d] * direction[d]
            norm = np.sqrt(norm)
            if norm > rank_tolerance * norm_before and norm > 1e-12:
                for d in range(n):
                    direction[d] /= norm
                for r in range(n):
                    scaled = weight * direction[r]
                    for c in range(n):
                        out[r, c] -= scaled * direction[c]
                rank += 1


@njit(cache=True)
def damped_projector(
    jacobian: Array, starts: Starts, alpha_row: Array, damping: float, out: Array
) -> None:  # pragma: no cover
    """P_i = I - sum_l (a_(l) - a_(l+1)) Pi_l with damped layers, written to the (n, n) `out`.

    Pi_l = J_l^T (J_l J_l^T + e^2 I)^-1 J_l over the first l tasks sorted by alpha: the layer-cake
    form of eq. 11 in which the range projectors are continuous in q through rank changes.
    """
    n = jacobian.shape[1]
    out[:, :] = 0.0
    for d in range(n):
        out[d, d] = 1.0
    order = descending_order(alpha_row)
    k = alpha_row.shape[0]
    stacked = np.empty((jacobian.shape[0], n))
    rows = 0
    for level in range(k):
        task = order[level]
        for row in range(starts[task], starts[task + 1]):
            stacked[rows] = jacobian[row]
            rows += 1
        following = alpha_row[order[level + 1]] if level + 1 < k else 0.0
        share = alpha_row[task] - following
        if share > 0.0 and rows > 0:
            layer = stacked[:rows]
            gram = layer @ layer.T
            for d in range(rows):
                gram[d, d] += damping * damping
            out -= share * (layer.T @ np.linalg.solve(gram, layer))


@njit(cache=True)
def projector(
    jacobian: Array,
    starts: Starts,
    alpha_row: Array,
    rank_tolerance: float,
    damping: float,
    out: Array,
) -> None:  # pragma: no cover
    """Generalized projector of one task by the form that the settings ask for."""
    if damping > 0.0:
        damped_projector(jacobian, starts, alpha_row, damping, out)
    else:
        exact_projector(jacobian, starts, alpha_row, rank_tolerance, out)


@njit(cache=True)
def _all_projectors(
    jacobian: Array, starts: Starts, alpha: Array, rank_tolerance: float, damping: float
) -> Array:  # pragma: no cover
    k = alpha.shape[0]
    n = jacobian.shape[1]
    result = np.empty((k, n, n))
    for i in range(k):
        projector(jacobian, starts, alpha[i], rank_tolerance, damping, result[i])
    return result


def generalized_projectors(
    jacobian: Array,
    starts: Starts,
    alpha: Array,
    settings: ProjectorSettings | None = None,
) -> Array:
    """Generalized projectors P_i(A_i) of all tasks (GHC paper, algorithms 1 and 2).

    Args:
        jacobian: (m, n) augmented Jacobian, eq. 10.
        starts: (k + 1,) first row of each task; the last entry is m.
        alpha: (k, k) priority matrix.
        settings: rank tolerance and optional damping of the layers.

    Returns:
        (k, n, n) symmetric projectors with eigenvalues in [0, 1].
    """
    settings = settings or ProjectorSettings()
    return _all_projectors(
        np.ascontiguousarray(jacobian, dtype=np.float64),
        np.asarray(starts, dtype=np.int64),
        np.ascontiguousarray(alpha, dtype=np.float64),
        settings.rank_tolerance,
        settings.layer_damping,
    )


def smallest_singular_value(projectors: Array) -> float:
    """Smallest singular value of [P_1 .. P_k]; (13b) is solvable where it is positive.

    Args:
        projectors: (k, n, n).
    """
    gram = np.einsum("kij,klj->il", projectors, projectors)
    return float(np.sqrt(max(np.linalg.eigvalsh(gram)[0], 0.0)))

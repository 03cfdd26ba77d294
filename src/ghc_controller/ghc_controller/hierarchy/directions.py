"""Compiled pieces of the generalized projectors: orders of tasks, and orthonormal directions."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ghc_controller.numerics.small_factors import REORDERED_SUMS
from ghc_controller.types import Array

Starts = NDArray[np.int64]


@njit(cache=True)
def descending_order(alpha_row: Array, dominance: Array) -> NDArray[np.int64]:  # pragma: no cover
    """Task indices by descending priority over one task; of a tie the more dominant comes first.

    Ties carry one weight, so their order is free: taking it from the whole matrix makes the rows
    of a strict hierarchy begin alike, and they share one basis.
    """
    k = alpha_row.shape[0]
    order = np.arange(k)
    for a in range(1, k):
        current = order[a]
        b = a - 1
        while b >= 0 and (
            alpha_row[order[b]] < alpha_row[current]
            or (
                alpha_row[order[b]] == alpha_row[current]
                and dominance[order[b]] < dominance[current]
            )
        ):
            order[b + 1] = order[b]
            b -= 1
        order[b + 1] = current
    return order


@njit(cache=True, fastmath=REORDERED_SUMS)
def add_directions(
    jacobian: Array, first: int, last: int, rank_tolerance: float, basis: Array, rank: int
) -> int:  # pragma: no cover
    """Append what rows first .. last - 1 add to the orthonormal `basis` (n, n); the new rank."""
    n = jacobian.shape[1]
    for row in range(first, last):
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
            rank += 1
    return rank


@njit(cache=True)
def selected_values(rows: Array) -> tuple[bool, Array]:  # pragma: no cover
    """Whether each row has one entry, in a column of its own, and these entries by column, (d,).

    So it is with a posture. J J^T is diagonal then, and what costs m^3 for other rows costs m.
    """
    values = np.zeros(rows.shape[1])
    for r in range(rows.shape[0]):
        found = False
        for c in range(rows.shape[1]):
            if rows[r, c] != 0.0:
                if found or values[c] != 0.0:
                    return False, values
                values[c] = rows[r, c]
                found = True
        if not found:
            return False, values
    return True, values


@njit(cache=True)
def subtract_direction(weight: float, direction: Array, out: Array) -> None:  # pragma: no cover
    """out (n, n) -= weight direction direction^T."""
    for r in range(direction.shape[0]):
        scaled = weight * direction[r]
        for c in range(direction.shape[0]):
            out[r, c] -= scaled * direction[c]


@njit(cache=True)
def write_scaled_identity(scale: float, out: Array) -> None:  # pragma: no cover
    """Write scale I to `out` (n, n)."""
    for r in range(out.shape[0]):
        for c in range(out.shape[1]):
            out[r, c] = scale if r == c else 0.0

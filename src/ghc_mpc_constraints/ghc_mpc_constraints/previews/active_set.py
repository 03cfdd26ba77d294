"""Dual active-set method (Goldfarb and Idnani 1983) in the space of the bounded rows.

The preview QPs of this package have hundreds of rows and a handful of active ones. Written in
y = C x with the bounds y <= b, the method needs no matrix but the columns C H^-1 C^T of the rows
that it takes in: each generator supplies them by its own structure, as they are asked for.
"""

from __future__ import annotations

import numba
import numpy as np

from ghc_controller.types import Array

CAPACITY = 64  # rows in the working set; previews have a few per jump in the horizon
MAX_CHANGES = 400  # rows taken in before the method gives up
FEASIBILITY = 1e-9  # [-] violation of a row that is accepted, relative to the size of the bounds
DEPENDENT = 1e-12  # [-] curvature left of a row after the others: below it, it is dependent


@numba.njit(cache=True)
def most_violated(y: Array, bound: Array, tolerance: float) -> int:
    """Row farthest above its bound; -1 when all are within the tolerance."""
    worst, row = tolerance, -1
    for i in range(y.shape[0]):
        excess = y[i] - bound[i]
        if excess > worst:
            worst, row = excess, i
    return row


@numba.njit(cache=True)
def feasibility_tolerance(bound: Array) -> float:
    """Violation that is accepted, in the unit of the bounds; infinite bounds do not count."""
    largest = 1.0
    for value in bound:
        if np.isfinite(value):
            largest = max(largest, abs(value))
    return FEASIBILITY * largest


@numba.njit(cache=True)
def _forget(slot: int, rows: Array, multipliers: Array, columns: Array, count: int) -> None:
    """Remove a slot; the ones after it, the candidate in slot `count` included, move up."""
    for k in range(slot, count):
        rows[k] = rows[k + 1]
        multipliers[k] = multipliers[k + 1]
        columns[k] = columns[k + 1]


@numba.njit(cache=True)
def take_in(
    y: Array, bound: Array, rows: Array, multipliers: Array, columns: Array, count: int
) -> int:
    """Make the candidate in slot `count` hold with equality; returns the new count.

    y (m,), rows, multipliers (CAPACITY,) and columns (CAPACITY, m), columns[k] = C H^-1 C^T of
    row rows[k], are updated in place. Returns -1 when the rows in hand conflict.
    """
    multipliers[count] = 0.0
    while True:
        candidate = rows[count]
        gram = np.empty((count, count))
        across = np.empty(count)
        for a in range(count):
            across[a] = columns[count, rows[a]]
            for b in range(count):
                gram[a, b] = columns[a, rows[b]]
        share = np.linalg.solve(gram, across) if count else np.zeros(0)
        curvature = columns[count, candidate]
        left = curvature - np.dot(share, across)
        independent = left > DEPENDENT * curvature
        step, blocking = np.inf, -1
        if independent:
            step = (y[candidate] - bound[candidate]) / left
        for a in range(count):
            if share[a] > 0.0 and multipliers[a] < step * share[a]:
                step, blocking = multipliers[a] / share[a], a
        if step == np.inf:
            return -1
        for a in range(count):
            multipliers[a] -= step * share[a]
        multipliers[count] += step
        if independent:
            for i in range(y.shape[0]):
                change = columns[count, i]
                for a in range(count):
                    change -= share[a] * columns[a, i]
                y[i] -= step * change
        if blocking < 0:
            return count + 1
        _forget(blocking, rows, multipliers, columns, count)
        count -= 1

"""Operation counts of one control step of every formulation, without its QPs.

As in law_operations: a product with its sum is one operation, products are dense, Jacobians,
targets and contacts are left out. d accelerations that the contacts leave, m_l rows of level l.
Laws that need the mass matrix count it with tau = M x; those of Jeong and Chang count as in
law_operations. QPs are counted by QpCounter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from benchmarks.law_operations import COUNTS, mass_matrix
from ghc_controller.hierarchy.levels import levels
from ghc_controller.hierarchy.priorities import Candidate, sum_of
from ghc_controller.types import Array, Starts


def gram_schmidt(d: int, count: int, before: int = 0) -> float:
    """Two passes over `count` rows below `before` independent ones; no rank beyond d."""
    return float(sum(4.0 * d * min(before + i, d) + 2.0 * d for i in range(count)))


def cascade(d: int, rows: Sequence[int]) -> float:
    """A = J P by the basis, (A A^T + w I)^-1, P A^T of it, and the basis of the next level."""
    total, rank = 0.0, 0
    for index, m in enumerate(rows):
        total += 2.0 * m * d * rank + m**2 * d + m**3 / 3.0 + m**2
        total += 2.0 * m * d + 2.0 * d * rank
        if index + 1 < len(rows):
            total += gram_schmidt(d, m, rank)
        rank = min(rank + m, d)
    return total


def hqp(d: int, rows: Sequence[int]) -> float:
    """J Z, its Hessian and factor, the step, the SVD of J Z and the next Z."""
    total, left = 0.0, d
    for m in rows:
        if left == 0:
            break
        kept = max(left - m, 0)
        total += m * d * left + m * left**2 + 2.0 * left**3 / 3.0 + 2.0 * left**2 + d * left
        total += 4.0 * left**2 * m + 8.0 * left * m**2 + 9.0 * min(m, left) ** 3
        total += d * left * kept
        left = kept
    return total


def rhp_hqp(d: int, rows: Sequence[int]) -> float:
    """J P, its Hessian and factor, P F, the step, B and P (I - B^T Lambda B)."""
    total = 0.0
    for index, m in enumerate(rows):
        total += 2.0 * m * d**2 + 2.0 * d**3 / 3.0 + d**3 + 3.0 * d**2
        if index + 1 < len(rows):
            total += m * d**2 + gram_schmidt(d, min(m, d)) + 2.0 * min(m, d) * d**2
    return total


def projectors(d: int, rows: Sequence[int]) -> float:
    """P_i of every task: a basis of all rows, and I - B^T A B."""
    whole = sum(rows)
    return len(rows) * (gram_schmidt(d, whole) + min(whole, d) * d**2)


def ghc(d: int, rows: Sequence[int]) -> float:
    """Projectors, J_i^T (J_i J_i^T + w I)^-1 b_i of every task."""
    return projectors(d, rows) + sum(m**2 * d + m**3 / 3.0 + m * d + d**2 for m in rows)


def balanced(d: int, rows: Sequence[int]) -> float:
    """Projectors, sum P_i J_i^T J_i and its inverse."""
    return projectors(d, rows) + sum(2.0 * m * d**2 + m * d + d**2 for m in rows) + d**3 + d**2


def weighted(d: int, rows: Sequence[int]) -> float:
    """sum gamma_i J_i^T J_i and its factor."""
    return sum(rows) * d**2 + 2.0 * d**3 / 3.0 + 2.0 * d**2


_PER_CANDIDATE: dict[str, Callable[[int, Sequence[int]], float]] = {
    "cascade": cascade,
    "hqp_transition": hqp,
}
_PER_STEP: dict[str, Callable[[int, Sequence[int]], float]] = {
    "hqp": hqp,
    "rhp_hqp": rhp_hqp,
    "ghc": ghc,
    "ghc_full": projectors,  # all else is in its QP
    "balanced": balanced,
    "weighted": weighted,
}


def law_operations(
    formulation: str, d: int, starts: Starts, candidates: Sequence[Candidate]
) -> float:
    """Operations of a step without its QPs; `starts` (k + 1,) first rows of the tasks."""
    sizes = tuple(int(size) for size in np.diff(starts))
    orders = tuple(_levels_of(each.alpha) for each in candidates)
    mixed = orders[0] if len(candidates) == 1 else _levels_of(sum_of(candidates))
    return _count(formulation, d, sizes, orders, mixed)


_Order = tuple[tuple[int, ...], ...]


def _levels_of(alpha: Array) -> _Order:
    return _remembered(alpha.tobytes(), alpha.shape[0])


@lru_cache(maxsize=4096)
def _remembered(alpha: bytes, k: int) -> _Order:
    return tuple(tuple(level) for level in levels(np.frombuffer(alpha).reshape(k, k)))


@lru_cache(maxsize=4096)
def _count(
    formulation: str, d: int, sizes: tuple[int, ...], orders: tuple[_Order, ...], mixed: _Order
) -> float:
    def rows(order: _Order) -> list[int]:
        return [sum(sizes[task] for task in level) for level in order]

    if formulation in COUNTS:
        return COUNTS[formulation](d, rows(mixed))
    dynamics = mass_matrix(d) + float(d**2)
    if formulation in _PER_CANDIDATE:
        return dynamics + sum(_PER_CANDIDATE[formulation](d, rows(order)) for order in orders)
    if formulation == "rhp_hqp":
        # A task that lies at different depths in the mixture is solved for at each of them.
        depth = max(len(order) for order in orders)
        solved: list[set[int]] = [set() for _ in range(depth)]
        for order in orders:
            for level, tasks in enumerate(order):
                solved[level] |= set(tasks)
        return dynamics + rhp_hqp(d, [sum(sizes[task] for task in level) for level in solved])
    per_task = [sizes[task] for level in mixed for task in level]
    by = per_task if formulation in ("ghc", "ghc_full", "balanced", "weighted") else rows(mixed)
    return dynamics + _PER_STEP[formulation](d, by)

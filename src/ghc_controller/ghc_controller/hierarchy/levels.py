"""Levels of a priority matrix, as used by a cascade of strict orders."""

from __future__ import annotations

from ghc_controller.types import Array


def levels(alpha: Array) -> list[list[int]]:
    """Active tasks by level, highest first; tasks dominated by equally many others share a level.

    alpha (k, k); an entry above 1/2 counts as "above", a diagonal entry above 1/2 as removed.
    """
    active = [i for i in range(alpha.shape[0]) if alpha[i, i] <= 0.5]
    above = {i: sum(alpha[i, j] > 0.5 for j in active if j != i) for i in active}
    return [[i for i in active if above[i] == count] for count in sorted(set(above.values()))]


def is_order(alpha: Array) -> bool:
    """True for a weak order: strict between levels, ties within a level, tasks on or off.

    False for values that no order has: between 0 and 1 across levels, cycles, one-sided ties,
    partly removed tasks.
    """
    ranked = levels(alpha)
    if any(alpha[i, i] > 0.0 for level in ranked for i in level):
        return False
    if any(0.5 < alpha[i, i] < 1.0 for i in range(alpha.shape[0])):
        return False
    rank = {task: depth for depth, level in enumerate(ranked) for task in level}
    for i in rank:
        for j in rank:
            if rank[j] < rank[i] and (alpha[i, j], alpha[j, i]) != (1.0, 0.0):
                return False
            if i != j and rank[i] == rank[j] and alpha[i, j] != alpha[j, i]:
                return False
    return True

"""Levels of several orders on one common scale of slots, for matrices that mix them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.hierarchy.levels import levels
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.types import Array

Levels = Sequence[Sequence[int]]  # tasks by level, highest first; a slot without tasks is empty


class LevelSlots:
    """Assigns each level of each candidate of a mixture to a slot, constant during a mixture.

    A task that keeps its place keeps its slot when others are inserted or removed, so that only
    tasks whose order changes move. There are at most as many slots as levels in the longest
    order. An empty slot costs nothing.
    """

    def __init__(self) -> None:
        self._kept: dict[bytes, tuple[tuple[int, ...], ...]] = {}

    def priority_matrix(self, candidates: Sequence[Candidate]) -> Array:
        """(l, k) Phi = sum_c rho_c Phi_c (RHP-HQP, eq. 1 and 11) of candidates (k, k).

        phi_ij = 1 where task j is in slots 1 to i, 0 where it is not.
        """
        slots = self._slots(candidates)
        phi = np.zeros((max(map(len, slots)), candidates[0].alpha.shape[0]))
        for depth in range(phi.shape[0]):
            for filled, candidate in zip(slots, candidates, strict=True):
                above = [task for slot in filled[: depth + 1] for task in slot]
                phi[depth, above] += candidate.share
        return np.minimum(phi, 1.0)

    def _slots(self, candidates: Sequence[Candidate]) -> list[tuple[tuple[int, ...], ...]]:
        """Tasks by slot of each candidate, all of one length."""
        keys = [candidate.alpha.tobytes() for candidate in candidates]
        kept = {key: self._kept[key] for key in keys if key in self._kept}
        if len(keys) == 1 and not all(kept.get(keys[0], ((),))):
            kept = {}  # nothing to align with: drop the empty slots of the previous ramp
        for key, candidate in zip(keys, candidates, strict=True):
            if key not in kept:
                kept = aligned(kept, key, [tuple(level) for level in levels(candidate.alpha)])
        self._kept = kept
        return [kept[key] for key in keys]


def aligned(
    others: dict[bytes, tuple[tuple[int, ...], ...]], key: bytes, order: Levels
) -> dict[bytes, tuple[tuple[int, ...], ...]]:
    """Slots of `others` (all of equal length) and of one more order, stored under its key.

    The shorter one is spread over the slots of the longer one such that as many tasks as
    possible share a slot; the slots of `others` stay aligned with each other.
    """
    count = len(next(iter(others.values()))) if others else 0
    united = [{task for filled in others.values() for task in filled[s]} for s in range(count)]
    wanted = [set(level) for level in order]
    if len(wanted) <= count:
        places = _places(wanted, united)
        return others | {key: _spread(order, places, count)}
    places = _places(united, wanted)
    moved = {name: _spread(filled, places, len(wanted)) for name, filled in others.items()}
    return moved | {key: tuple(tuple(level) for level in order)}


def _spread(order: Levels, places: Sequence[int], count: int) -> tuple[tuple[int, ...], ...]:
    slots: list[tuple[int, ...]] = [()] * count
    for level, place in zip(order, places, strict=True):
        slots[place] = tuple(level)
    return tuple(slots)


def _places(short: Sequence[set[int]], long: Sequence[set[int]]) -> list[int]:
    """Increasing indices of the sets of `short` among those of `long`, with most tasks in common.

    Ties are broken by the smallest shift.
    """
    a, b = len(short), len(long)
    best = np.full((a + 1, b + 1), -np.inf)
    best[0] = 0.0
    for i in range(1, a + 1):
        for j in range(i, b + 1):
            common = len(short[i - 1] & long[j - 1]) - 1e-3 * (j - i)
            best[i, j] = max(best[i, j - 1], best[i - 1, j - 1] + common)
    places, j = [], b
    for i in range(a, 0, -1):
        while best[i, j] == best[i, j - 1]:
            j -= 1
        j -= 1
        places.append(j)
    return places[::-1]

"""Pairs that overlap where a run begins: what cannot be kept apart has no row."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from ghc_controller.constraints.bodies.pairs import Pair
from ghc_controller.types import Array

FADE = 0.5  # [s] over which the row of a pair that was left out comes into force


class LeftOut:
    """Which of p pairs have no row because they overlapped at the first state.

    Two bodies of the robot stay left out: their shapes are too large for them. A body and an
    obstacle that touched, as after a restart in touch, are looked at again from the first state
    on at which all their shapes are above the margin; their rows come into force over `FADE`.

    Attributes:
        touching: the pairs that are left out now; None before the first state.
        watched: (p,) whether a pair may have a row.
    """

    def __init__(self, pairs: Sequence[Pair], obstacles: Collection[str]) -> None:
        self._pairs = tuple(pairs)
        self._may_return = [a in obstacles or b in obstacles for a, b in pairs]
        self.reset()

    def reset(self) -> None:
        """The next state is the first one."""
        self.touching: tuple[Pair, ...] | None = None
        self.watched: NDArray[np.bool_] = np.ones(len(self._pairs), dtype=bool)
        self._waiting: list[int] = []
        self._since: dict[int, float] = {}  # [s] pair -> when it was above its margin again

    def begin(self, overlapping: Sequence[int], name: str) -> None:
        """Leave out the pairs that overlap at the first state, and warn of them by name."""
        found = list(dict.fromkeys(overlapping))
        self.watched[found] = False
        self.touching = tuple(self._pairs[pair] for pair in found)
        self._waiting = [pair for pair in found if self._may_return[pair]]
        own = self._named([pair for pair in found if not self._may_return[pair]])
        if own:
            warnings.warn(
                f"{name}: overlapping at the start and left out: {own}; list them under "
                "'excluded', or give these bodies smaller shapes",
                stacklevel=3,
            )
        others = self._named(self._waiting)
        if others:
            warnings.warn(
                f"{name}: in touch with an obstacle at the start, left out until they are above "
                f"their margins: {others}",
                stacklevel=3,
            )

    def _named(self, pairs: Sequence[int]) -> str:
        return ", ".join("-".join(self._pairs[pair]) for pair in pairs)

    def look(self, owner: NDArray[np.intp], room: Array, distance: Array, time: float) -> None:
        """Bring back the pairs that are apart.

        Args:
            owner: (k,) the pair of each near pair of shapes; those not given are far apart.
            room: (k,) [m] distance above the margin.
            distance: (k,) [m] of the surfaces.
            time: [s] of the state.
        """
        for pair in tuple(self._waiting):
            own = owner == pair
            if (np.minimum(room[own], distance[own]) <= 0.0).any():
                continue
            self._waiting.remove(pair)
            self.watched[pair] = True
            self.touching = tuple(one for one in self.touching or () if one != self._pairs[pair])
            self._since[pair] = time

    def relaxation(self, owner: NDArray[np.intp], time: float) -> Array | float:
        """(k,) [-] by how much rows of these pairs are relaxed for coming back; 0 = not at all."""
        if not self._since:
            return 0.0
        passed = np.array([time - self._since.get(int(pair), -np.inf) for pair in owner])
        share = np.clip(passed / FADE, 0.0, 1.0)
        with np.errstate(divide="ignore"):
            return np.asarray(1.0 / share - 1.0)

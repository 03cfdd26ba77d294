"""Distances of pairs of shapes on a moving robot, with their first and second derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ghc_controller.constraints.bodies.moving import PENALTY, WORLD, Placed, Side, added_motion
from ghc_controller.constraints.bodies.overlap import are_apart
from ghc_controller.core import BodyPairs
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import Array

_TOUCHING = 2e-4  # [m] below it the smooth distance may be that of an overlap
_LONGEST_ROW = 2.0  # [-] length of a gradient, 1 where the smooth distance is the true one

__all__ = ["PENALTY", "WORLD", "Motion", "Near", "PairGeometry", "Placed"]


class Near(NamedTuple):
    """Distances of k pairs of shapes, nearest first."""

    pairs: NDArray[np.int64]  # (k,) index of each pair
    distance: Array  # (k,) [m] of the surfaces, negative where they overlap
    u: Array  # (k, 6) places of the closest points, of the second shape and of the first

    def only(self, kept: NDArray[np.intp]) -> Near:
        """Some of them, by their places here."""
        return Near(self.pairs[kept], self.distance[kept], self.u[kept])


class Motion(NamedTuple):
    """Terms of d'' = jacobian x + drift of k distances."""

    rate: Array  # (k,) [m/s] d'
    jacobian: Array  # (k, n)
    drift: Array  # (k,) [m/s^2]


class PairGeometry:
    """All pairs of shapes that are looked at; which of them are near, and how they move.

    The distance is a lower bound of the true one with a continuous gradient: see the header.

    Attributes:
        model: that places the shapes; another one has the same frames, as a copy of it.
    """

    def __init__(
        self, model: RobotModel, shapes: Sequence[Placed], pairs: Sequence[tuple[int, int]]
    ) -> None:
        """Pairs by the indices of their shapes."""
        self.model, self._shapes = model, list(shapes)
        self._at_first = [placed.shape for placed in shapes]
        self._pairs = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        self._frames = np.array([placed.frame for placed in shapes], dtype=np.int64)
        self._radii = np.array([placed.shape.radius for placed in shapes], dtype=np.float64)
        axes = np.zeros((len(shapes), 3, 3))
        for row, placed in enumerate(shapes):
            axes[row, :, : placed.shape.axes.shape[1]] = placed.shape.axes
        self._axes = axes.reshape(-1, 9)
        self._moves = np.zeros((2, len(shapes), 3))  # [m/s], [m/s^2] of shapes in the world
        self._build()

    def _build(self) -> None:
        centers = np.array([placed.shape.center for placed in self._shapes], dtype=np.float64)
        self._core = BodyPairs(self._frames, centers, self._axes, self._radii, self._pairs)

    def move(self, states: Mapping[int, Array]) -> None:
        """Shapes in the world that translate.

        Args:
            states: index of a shape -> (3, 3) its way from where it was made [m], its velocity
                [m/s] and acceleration [m/s^2]; of all others as before.
        """
        for index, (way, *moves) in states.items():
            first = self._at_first[index]
            self._shapes[index] = Placed(replace(first, center=first.center + way), WORLD)
            self._moves[:, index] = moves
        self._build()

    def rest(self) -> None:
        """All shapes in the world where they were made, at rest."""
        moved = [k for k, frame in enumerate(self._frames) if frame == WORLD]
        self.move(dict.fromkeys(moved, np.zeros((3, 3))))

    def near(self, within: float) -> Near:
        """Pairs closer than `within` [m] at the state of the last `model.update`."""
        return Near(*self._core.near(self.model.core, within))

    def overlapping(self) -> NDArray[np.int64]:
        """Pairs that overlap at this state, or are so near that the smooth distance has no use.

        The smooth distance is never larger than the true one: negative, it proves nothing.
        """
        near = self.near(_TOUCHING)
        return near.pairs[[not self._has_use(near, row) for row in range(len(near.pairs))]]

    def _has_use(self, near: Near, row: int) -> bool:
        first, second = self._pairs[near.pairs[row]]
        u, radii = near.u[row], float(self._radii[first] + self._radii[second])
        one = Side.of(self.model, self._shapes[first], u[3:])
        other = Side.of(self.model, self._shapes[second], u[:3])
        between, axes = other.center - one.center, np.hstack([other.axes, -one.axes])
        longest = _LONGEST_ROW * (float(near.distance[row]) + radii)
        return bool(np.linalg.norm(between + axes @ u) <= longest) and are_apart(
            between, axes, u, radii
        )

    def motion(self, near: Near) -> Motion:
        """How these distances move; of the same state as `near`."""
        found = Motion(*self._core.motion(self.model.core, *near))
        if self._moves.any():
            first, second = self._pairs[near.pairs].T
            moves = self._moves[:, second] - self._moves[:, first]
            for row in np.flatnonzero(moves.any(axis=(0, 2))):
                self._add(found, near, int(row), moves[:, row])
        return found

    def _add(self, found: Motion, near: Near, row: int, moves: Array) -> None:
        first, second = self._pairs[near.pairs[row]]
        u = near.u[row]
        one = Side.of(self.model, self._shapes[first], u[3:])
        other = Side.of(self.model, self._shapes[second], u[:3])
        length = float(near.distance[row] + self._radii[first] + self._radii[second])
        rate, drift = added_motion(one, other, u, length, float(found.rate[row]), moves)
        found.rate[row] += rate
        found.drift[row] += drift

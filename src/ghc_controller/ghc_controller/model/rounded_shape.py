"""Shapes of bodies: a point, a segment or a box, each thickened by a radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """The points center + axes u with |u_k| <= 1, and all within `radius` of them.

    A sphere has no axis, a capsule one, a box three.
    """

    center: Array  # (3,) [m] in the frame of its link, or in the world
    axes: Array  # (3, k) [m] half axes as columns, k = 0, 1 or 3
    radius: float  # [m]

    @classmethod
    def capsule(cls, start: Array, end: Array, radius: float) -> Shape:
        """About the segment from start to end (3,) [m]; a sphere where both are the same."""
        half = 0.5 * (end - start)
        axes = half.reshape(3, 1) if np.any(half) else np.zeros((3, 0))
        return cls(0.5 * (start + end), axes, radius)

    @classmethod
    def box(cls, center: Array, size: Array, rotation: Array, radius: float = 0.0) -> Shape:
        """Edges of `size` (3,) [m] along the columns of `rotation` (3, 3)."""
        return cls(center, rotation * (0.5 * size), radius)

    @property
    def reach(self) -> float:
        """Radius [m] of a ball about its center that contains it."""
        return float(np.linalg.norm(np.linalg.norm(self.axes, axis=0))) + self.radius

    def ends(self) -> tuple[Shape, ...]:
        """Balls at the two ends of a capsule; none of another shape."""
        if self.axes.shape[1] != 1:
            return ()
        half, none = self.axes[:, 0], np.zeros((3, 0))
        return tuple(Shape(self.center + side * half, none, self.radius) for side in (-1.0, 1.0))

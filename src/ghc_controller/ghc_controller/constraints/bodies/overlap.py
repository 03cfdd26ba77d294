"""Whether two shapes overlap, where their smooth distance is too small to tell."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array

_MOST_SWEEPS = 200
_TINY = 1e-12  # [m^2] axis of no length


def are_apart(between: Array, axes: Array, u: Array, radii: float) -> bool:
    """Whether the cores of two shapes are farther from each other than `radii` [m].

    Moves the points u towards the closest ones, along one axis at a time, until either a plane
    normal to p = between + axes u separates both shapes, or these points are closer than `radii`.

    Args:
        between: (3,) [m] from the center of the first to that of the second.
        axes: (3, 6) [m] of the second, and of the first with the opposite sign.
        u: (6,) where to begin, |u_k| <= 1.
        radii: of both shapes together.
    """
    places = u.copy()
    squares = np.sum(axes * axes, axis=0)
    for _ in range(_MOST_SWEEPS):
        gap = between + axes @ places
        length = float(np.linalg.norm(gap))
        if length <= radii or length <= 0.0:
            return False
        if float(gap @ between) - float(np.abs(gap @ axes).sum()) > radii * length:
            return True
        for k in np.flatnonzero(squares > _TINY):
            moved = np.clip(places[k] - axes[:, k] @ gap / squares[k], -1.0, 1.0)
            gap = gap + axes[:, k] * (moved - places[k])
            places[k] = moved
    return False

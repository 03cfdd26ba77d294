"""Bodies of a robot and obstacles around it: their shapes, and the pairs that keep a distance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ghc_controller.constraints.bodies.geometry import WORLD, Near, PairGeometry, Placed
from ghc_controller.constraints.bodies.pairs import Pair
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.model.rounded_shape import Shape
from ghc_controller.types import Array

_OF_SECOND, _OF_FIRST = 0, 3  # first axes of both shapes in u
_SAME_END = 1e-9  # [-]


class Body(NamedTuple):
    """Shapes that are fixed to one link."""

    frame: str  # of the URDF; empty = the world
    shapes: tuple[Shape, ...]


class Watched(NamedTuple):
    """Pairs of shapes that belong to pairs of bodies."""

    geometry: PairGeometry
    owner: NDArray[np.intp]  # (p,) index of the pair of bodies that a pair of shapes belongs to
    whole: NDArray[np.intp]  # (p,) pair of capsules that has this one of an end; itself for others
    place: NDArray[np.intp]  # (p,) of that end in u of the whole pair
    side: Array  # (p,) [-] -1 or 1, u at that end; NaN for others
    shapes: Mapping[str, range]  # body -> indices of its shapes and their ends

    def same_as_whole(self, near: Near) -> NDArray[np.bool_]:
        """(k,) whether a pair of an end is where the closest points of the whole pair are."""
        u = np.full((len(self.owner), 6), np.nan)
        u[near.pairs] = near.u
        of_whole = u[self.whole[near.pairs], self.place[near.pairs]]
        return np.asarray(np.abs(of_whole - self.side[near.pairs]) < _SAME_END)


def watched(model: RobotModel, bodies: Mapping[str, Body], pairs: Sequence[Pair]) -> Watched:
    """Geometry of these pairs of bodies.

    A pair of capsules also gets pairs of the ends of each with the other: where both are
    parallel, the closest points move from one end to the other, and that end must be able to stop
    as well.
    """
    shapes: list[Placed] = []
    own: dict[str, list[tuple[int, tuple[int, ...]]]] = {}
    indices: dict[str, range] = {}
    for name, body in bodies.items():
        first_of_body = len(shapes)
        frame = model.frame_id(body.frame) if body.frame else WORLD
        for shape in body.shapes:
            number = len(shapes)
            shapes += [Placed(one, frame) for one in (shape, *shape.ends())]
            own.setdefault(name, []).append((number, tuple(range(number + 1, len(shapes)))))
        indices[name] = range(first_of_body, len(shapes))
    found: list[tuple[int, int]] = []
    about: list[tuple[int, int, int, float]] = []  # owner, whole, place, side
    for number, (a, b) in enumerate(pairs):
        for first, ends in own[a]:
            for second, other_ends in own[b]:
                whole = len(found)
                found.append((first, second))
                about.append((number, whole, 0, np.nan))
                if not (ends and other_ends):
                    continue
                found += [(end, second) for end in ends] + [(first, end) for end in other_ends]
                for place in (_OF_FIRST, _OF_SECOND):
                    about += [(number, whole, place, side) for side in (-1.0, 1.0)]
    owner, wholes, places, sides = (np.array(values) for values in zip(*about, strict=True))
    geometry = PairGeometry(model, shapes, found)
    return Watched(geometry, owner, wholes, places, sides, indices)

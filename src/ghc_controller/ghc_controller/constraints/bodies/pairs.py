"""Which bodies keep a distance from which."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from fnmatch import fnmatchcase
from itertools import combinations

from ghc_controller.errors import UnknownName
from ghc_controller.model.robot_model import RobotModel

Pair = tuple[str, str]


def chosen_pairs(
    wanted: Sequence[Pair], names: Sequence[str], fixed: Collection[str]
) -> list[Pair]:
    """Pairs of bodies that some of the `wanted` patterns name, in the order of `names`.

    Args:
        wanted: two patterns each, as `left_*` or a name; a pair counts in either order.
        names: of all bodies and obstacles.
        fixed: those that do not move, the obstacles: two of them are no pair.

    Raises:
        UnknownName: a pattern that no name matches.
    """
    for pattern in (part for pair in wanted for part in pair):
        if not any(fnmatchcase(name, pattern) for name in names):
            raise UnknownName("body", pattern, names)
    return [
        (a, b)
        for a, b in combinations(names, 2)
        if not (a in fixed and b in fixed)
        and any(_match(a, b, pair) or _match(b, a, pair) for pair in wanted)
    ]


def without_neighbors(
    pairs: Sequence[Pair], frame_of: Mapping[str, str], model: RobotModel
) -> list[Pair]:
    """The pairs without those of one link, and of two links that one joint connects.

    Args:
        frame_of: body -> link; obstacles have none.
    """
    chains = {frame: model.chain(frame) for frame in set(frame_of.values())}

    def apart(a: str, b: str) -> bool:
        if a not in frame_of or b not in frame_of:
            # A body that no joint moves cannot keep away from anything that rests.
            return any(chains[frame_of[one]] for one in (a, b) if one in frame_of)
        return len(chains[frame_of[a]] ^ chains[frame_of[b]]) > 1

    return [(a, b) for a, b in pairs if apart(a, b)]


def _match(a: str, b: str, pair: Pair) -> bool:
    return fnmatchcase(a, pair[0]) and fnmatchcase(b, pair[1])

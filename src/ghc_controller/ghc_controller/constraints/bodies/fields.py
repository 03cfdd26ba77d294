"""What robot.yaml says of distances between bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from ghc_controller.constraints.bodies.collection import Body
from ghc_controller.constraints.bodies.pairs import Pair
from ghc_controller.constraints.bodies.shapes import BodyFields, ShapeFields
from ghc_controller.constraints.registry import ConstraintFields
from ghc_controller.errors import UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import AT_LEAST_ONE, POSITIVE
from ghc_controller.schema.reader import Fields

_EVERYTHING: tuple[Pair, ...] = (("*", "*"),)


def _read_pairs(fields: Fields, name: str) -> tuple[Pair, ...]:
    """A list of pairs of names or patterns; 'all' for every one."""
    value = fields.value(name, [])
    if value == "all":
        return _EVERYTHING
    whole = isinstance(value, list | tuple)
    if not whole or not all(
        isinstance(pair, list | tuple) and len(pair) == 2 and all(isinstance(x, str) for x in pair)
        for pair in value
    ):
        raise fields.error(name, f"'all' or pairs of names expected, {value!r} given")
    return tuple((pair[0], pair[1]) for pair in value)


def _pairs_schema(_: Any) -> dict[str, Any]:
    pair = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
    return {"anyOf": [{"const": "all"}, {"type": "array", "items": pair}]}


@dataclass(frozen=True, slots=True, kw_only=True)
class MarginFields:
    """Pairs with a margin of their own."""

    pairs: tuple[Pair, ...] = declared(
        "names of bodies and obstacles, or patterns such as left_*; left out = all",
        _EVERYTHING,
        read=lambda fields, name: _read_pairs(fields, name) or _EVERYTHING,
        schema=_pairs_schema,
    )
    margin: float = declared("distance to be kept; -1 = none until a preview raises it", unit="m")


@dataclass(frozen=True, slots=True, kw_only=True)
class ObstacleFields(ShapeFields):
    """A shape in the world."""

    moves: bool = declared(
        "with the obstacle of this name in the plan of obstacle_motion, whose position is its "
        "center",
        False,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyDistanceFields(ConstraintFields):
    """Fields of the kind `body_distance`."""

    bodies: Mapping[str, BodyFields] = declared("name: shape on a link", dict)
    links: tuple[str, ...] = declared(
        "links, or patterns of their names, whose collision shapes in the URDF are bodies too", ()
    )
    obstacles: Mapping[str, ObstacleFields] = declared("name: shape in the world", dict)
    margins: Mapping[str, MarginFields] = declared(
        "name: pairs and their margin; a pair belongs to the first that names it"
    )
    excluded: tuple[Pair, ...] = declared(
        "pairs that may touch, besides neighboring links and what overlaps at the start",
        (),
        read=_read_pairs,
        schema=_pairs_schema,
    )
    brake: float = declared("deceleration before a margin", 5.0, unit="m/s^2", domain=POSITIVE)
    influence: float = declared(
        "above a margin, from which on a pair is looked at", 0.25, unit="m", domain=POSITIVE
    )
    most: int = declared(
        "rows at most, of the nearest; more where more pairs are within a fifth of `influence`",
        16,
        unit="-",
        domain=AT_LEAST_ONE,
    )


def bodies_of_links(
    given: BodyDistanceFields, fields: Fields, model: RobotModel
) -> dict[str, Body]:
    """Bodies by the names of their links; those that `bodies` states stay as stated."""
    names = set()
    for pattern in given.links:
        matches = [name for name in model.frame_names if fnmatchcase(name, pattern)]
        if not matches:
            raise fields.error("links", str(UnknownName("link", pattern, model.frame_names)))
        names |= set(matches) - given.bodies.keys()
    found = model.collision_shapes(names) if names else {}
    if given.links and not found:
        raise fields.error("links", f"{', '.join(given.links)}: no collision shape in the URDF")
    return {name: Body(name, shapes) for name, shapes in found.items()}

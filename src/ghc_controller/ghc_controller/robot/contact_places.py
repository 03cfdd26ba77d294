"""Where the contacts of a robot are on its body: read once, for controller and simulator."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ghc_controller.schema.reader import Fields

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class ContactPlace:
    """A frame and the points of it that may touch."""

    frame: str
    points: tuple[Vector, ...]  # [m] in the frame


def contact_places(entries: Iterable[Fields]) -> Mapping[str, ContactPlace]:
    """Name -> place, of the entries of `contacts` in robot.yaml.

    Without points, as a kind of a plug-in may have it, the frame's origin is the point. Raises
    ConfigurationError as the reader of contacts does.
    """
    return {entry.text("name"): _place(entry) for entry in entries}


def _place(entry: Fields) -> ContactPlace:
    points = entry.vectors("points", 3, default=((0.0, 0.0, 0.0),))
    return ContactPlace(entry.text("frame"), tuple((x, y, z) for x, y, z in points))

"""Markers by name: added anew for each array, removed where they are not added again."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ghc_controller.types import Array
from ghc_sim_bridge.colors import Rgba

_MOST_IDS = 1 << 31  # [-] of a marker
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)


class Marks:
    """Collects the markers of one instant in one frame."""

    def __init__(self, frame: str) -> None:
        """`frame`: frame_id of all of them."""
        self._frame = frame
        self._ids: dict[tuple[str, str], int] = {}  # (namespace, name) -> id, while it is shown
        self._free = count()
        self._shown: set[tuple[str, str]] = set()
        self._new: dict[tuple[str, str], Marker] = {}
        self._stamp = Time()

    def begin(self, stamp: Time) -> None:
        """Start the array of a time."""
        self._stamp = stamp
        self._new = {}

    def sphere(self, group: str, name: str, at: Array, diameter: float, color: Rgba) -> None:
        """Ball of a diameter [m]."""
        self._add(group, name, Marker.SPHERE, at, (diameter,) * 3, color)

    def box(self, group: str, name: str, at: Array, size: Array, color: Rgba) -> None:
        """Box of full lengths [m] along the axes of the frame."""
        self._add(group, name, Marker.CUBE, at, size.tolist(), color)

    def text(self, group: str, name: str, at: Array, height: float, color: Rgba) -> None:
        """The name itself, upright, letters of a height [m]."""
        self._add(group, name, Marker.TEXT_VIEW_FACING, at, (0.0, 0.0, height), color).text = name

    def arrow(self, group: str, name: str, start: Array, end: Array, color: Rgba) -> None:
        """Arrow between two points."""
        marker = self._add(group, name, Marker.ARROW, None, (0.008, 0.02, 0.03), color)
        marker.points = [_point(start), _point(end)]

    def lines(
        self, group: str, name: str, ends: Sequence[Array], width: float, colors: Sequence[Rgba]
    ) -> None:
        """Lines from each even end to the next one; a color for each line."""
        marker = self._add(group, name, Marker.LINE_LIST, None, (width, 0.0, 0.0), colors[0])
        marker.points = [_point(end) for end in ends]
        marker.colors = [_color(color) for color in colors for _ in range(2)]

    def message(self) -> MarkerArray:
        """What was added since `begin`, and the end of what was shown before."""
        gone = []
        for key in sorted(self._shown - set(self._new)):
            # Forgotten: a tracker may give every obstacle that comes a name of its own.
            marker = Marker(ns=key[0], id=self._ids.pop(key), action=Marker.DELETE)
            marker.header.frame_id, marker.header.stamp = self._frame, self._stamp
            gone.append(marker)
        self._shown = set(self._new)
        return MarkerArray(markers=[*gone, *self._new.values()])

    def _add(
        self,
        group: str,
        name: str,
        kind: int,
        at: Array | None,
        scale: Sequence[float],
        color: Rgba,
    ) -> Any:
        key = (group, name)
        number = self._ids.get(key)
        if number is None:
            number = self._ids[key] = next(self._free) % _MOST_IDS
        marker = Marker(ns=group, id=number, type=kind, action=Marker.ADD, color=_color(color))
        marker.header.frame_id, marker.header.stamp = self._frame, self._stamp
        if at is not None:
            marker.pose.position = _point(at)
        turn = marker.pose.orientation
        turn.x, turn.y, turn.z, turn.w = _UPRIGHT
        marker.scale.x, marker.scale.y, marker.scale.z = map(float, scale)
        self._new[key] = marker
        return marker


def _point(at: Array) -> Point:
    return Point(x=float(at[0]), y=float(at[1]), z=float(at[2]))


def _color(color: Rgba) -> ColorRGBA:
    red, green, blue, opacity = color
    return ColorRGBA(r=red, g=green, b=blue, a=opacity)

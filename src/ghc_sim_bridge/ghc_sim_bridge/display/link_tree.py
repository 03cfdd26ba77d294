"""The links of a URDF as a tree of transforms, moved by joint positions by name.

For drawing only: any URDF, also with mimic and continuous joints, which the robot model of the
controller does not have. The dynamics stay with Pinocchio.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.numerics.rotation import quaternion_from_matrix
from ghc_controller.robot.urdf_frames import origin_of, vector
from ghc_controller.types import Array

_TURNING, _SLIDING = ("revolute", "continuous"), ("prismatic",)


class Transform(NamedTuple):
    """Place of a link in its parent."""

    parent: str
    child: str
    translation: Array  # (3,) [m]
    quaternion: Array  # (4,) x, y, z, w


class Follows(NamedTuple):
    """A joint's position: multiplier times that of the joint `leader`, plus offset."""

    leader: str
    multiplier: float
    offset: float  # [rad] or [m]


@dataclass(frozen=True)
class _Moving:
    name: str
    parent: str
    child: str
    slides: bool
    place: Transform  # at zero
    axis: Array  # (3,) unit, in the joint's frame
    along: Array  # (3,) the same in the parent's frame


class LinkTree:
    """Transforms from each link to its parent.

    Attributes:
        root: link without a parent.
        fixed: transforms that never change.
        joints: names of the joints that positions are asked of; mimic joints follow them.
    """

    def __init__(self, urdf: str | bytes, source: str) -> None:
        """Read the text of a URDF; `source` names it in messages.

        Raises:
            ConfigurationError: no URDF, no tree, a joint of several coordinates, or one that
                mimics a joint that is not there.
        """
        self._source = source
        try:
            robot = ElementTree.fromstring(urdf)
        except ElementTree.ParseError as error:
            raise ConfigurationError(f"{source}: cannot be read as XML: {error}") from error
        fixed, moving, follows = [], [], {}
        for joint in robot.iterfind("joint"):
            entry = self._joint(joint)
            if isinstance(entry, Transform):
                fixed.append(entry)
                continue
            moving.append(entry)
            mimic = joint.find("mimic")
            if mimic is not None:
                follows[entry.name] = Follows(
                    mimic.get("joint", ""),
                    float(mimic.get("multiplier") or 1.0),
                    float(mimic.get("offset") or 0.0),
                )
        self.fixed = tuple(fixed)
        self._moving = tuple(moving)
        self._follows = {name: self._resolved(name, follows) for name in follows}
        self.joints = tuple(joint.name for joint in moving if joint.name not in follows)
        self.root = self._root(robot)
        self._at_zero = np.array([joint.place.translation for joint in moving]).reshape(-1, 3)
        self._turned = np.array([joint.place.quaternion for joint in moving]).reshape(-1, 4)
        self._axes = np.array([joint.axis for joint in moving]).reshape(-1, 3)
        self._along = np.array([joint.along for joint in moving]).reshape(-1, 3)
        self._slides = np.array([joint.slides for joint in moving], dtype=np.bool_)

    def moving(self, positions: Mapping[str, float]) -> list[Transform]:
        """Transforms of the joints that move, at `positions` [rad] or [m] by joint name.

        A joint without a position is at zero.
        """
        values = np.array([self._position(joint.name, positions) for joint in self._moving])
        slid, angle = np.where(self._slides, values, 0.0), np.where(self._slides, 0.0, values)
        half = 0.5 * angle[:, None]
        turns = np.concatenate([self._axes * np.sin(half), np.cos(half)], axis=1)
        translations = self._at_zero + self._along * slid[:, None]
        quaternions = _products(self._turned, turns)
        return [
            Transform(joint.parent, joint.child, translation, quaternion)
            for joint, translation, quaternion in zip(
                self._moving, translations, quaternions, strict=True
            )
        ]

    def _position(self, name: str, positions: Mapping[str, float]) -> float:
        follows = self._follows.get(name)
        if follows is None:
            return float(positions.get(name, 0.0))
        return follows.multiplier * float(positions.get(follows.leader, 0.0)) + follows.offset

    def _joint(self, joint: Element) -> Transform | _Moving:
        name, kind = joint.get("name", ""), joint.get("type", "")
        matrix = origin_of(joint)
        place = Transform(
            _link(joint, "parent"),
            _link(joint, "child"),
            matrix[:3, 3].copy(),
            quaternion_from_matrix(np.ascontiguousarray(matrix[:3, :3])),
        )
        if kind == "fixed":
            return place
        if kind not in (*_TURNING, *_SLIDING):
            raise ConfigurationError(
                f"{self._source}: joint '{name}' is of type '{kind}'; fixed, revolute, continuous "
                "and prismatic joints can be drawn"
            )
        element = joint.find("axis")
        axis = vector("1 0 0" if element is None else element.get("xyz", "1 0 0"))
        length = float(np.linalg.norm(axis))
        if not length > 0.0:
            raise ConfigurationError(f"{self._source}: joint '{name}': axis of length 0")
        axis = axis / length
        slides = kind in _SLIDING
        return _Moving(name, place.parent, place.child, slides, place, axis, matrix[:3, :3] @ axis)

    def _resolved(self, name: str, follows: Mapping[str, Follows]) -> Follows:
        """What a joint follows in the end, where one mimic joint follows another."""
        entry, seen = follows[name], [name]
        while entry.leader in follows:
            if entry.leader in seen:
                raise ConfigurationError(
                    f"{self._source}: mimic joints follow each other: {', '.join(seen)}"
                )
            seen.append(entry.leader)
            above = follows[entry.leader]
            entry = Follows(
                above.leader,
                entry.multiplier * above.multiplier,
                entry.multiplier * above.offset + entry.offset,
            )
        return entry

    def _root(self, robot: Element) -> str:
        places = [*self.fixed, *(joint.place for joint in self._moving)]
        children = {place.child for place in places}
        roots = [link.get("name", "") for link in robot.iterfind("link")]
        roots = [name for name in roots if name not in children]
        if len(roots) != 1:
            raise ConfigurationError(
                f"{self._source}: one link without a parent expected, given: "
                f"{', '.join(roots) or 'none'}"
            )
        return roots[0]


def _link(joint: Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def _products(a: Array, b: Array) -> Array:
    """Rows of quaternions of the rotations b followed by a, (m, 4)."""
    vector_part = a[:, 3:] * b[:, :3] + b[:, 3:] * a[:, :3] + np.cross(a[:, :3], b[:, :3])
    scalar = a[:, 3] * b[:, 3] - np.sum(a[:, :3] * b[:, :3], axis=1)
    return np.concatenate([vector_part, scalar[:, None]], axis=1)

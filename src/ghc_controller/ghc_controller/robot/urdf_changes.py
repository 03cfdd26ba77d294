"""A URDF with another root, with joints that are locked, and with frames of one's own.

A legged robot that stands on one foot is an arm whose base is that foot. The changed URDF is
written to the user's cache, once for each content, so that controller and simulator read one file.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.types import Array

_FORMAT = "1"  # of what is written: a new number makes old files of the cache unused
_LEVEL = 1e-9  # [-] cosine of the pitch below which roll and yaw are one angle


@dataclass(frozen=True, slots=True)
class UrdfChanges:
    """What a robot.yaml wants to be different; nothing by default."""

    root: str = ""  # link that becomes the base; "" = that of the file
    locked: tuple[str, ...] = ()  # joints that stay at zero
    frames: dict[str, tuple[str, Array]] = field(default_factory=dict)
    # name -> link, and position (3,) [m] of a frame in it, with its axes

    def write(self, urdf: Path, resource: Callable[[str, Path], Path]) -> Path:
        """Path of the changed URDF; that of `urdf` itself where nothing changes.

        Args:
            resource: file that a URI in a URDF means.

        Raises:
            UnknownName: a link or joint that the URDF has not.
            ConfigurationError: no URDF, or the changed one cannot be written.
        """
        if not (self.root or self.locked or self.frames):
            return urdf
        try:
            text = urdf.read_bytes()
            robot = ElementTree.fromstring(text)
        except (OSError, ElementTree.ParseError) as error:
            raise ConfigurationError(f"{urdf}: cannot be read as XML: {error}") from error
        frames = {name: (link, at.tolist()) for name, (link, at) in self.frames.items()}
        key = repr((_FORMAT, str(urdf), self.root, self.locked, frames)).encode()
        target = _cache() / f"{urdf.stem}_{hashlib.sha256(key + text).hexdigest()[:16]}.urdf"
        if not target.is_file():
            self._change(robot, urdf, resource)
            _write(target, ElementTree.tostring(robot, encoding="unicode"))
        return target

    def _change(self, robot: Element, urdf: Path, resource: Callable[[str, Path], Path]) -> None:
        joints = {joint.get("name", ""): joint for joint in robot.iterfind("joint")}
        links = {link.get("name", ""): link for link in robot.iterfind("link")}
        for name in self.locked:
            if name not in joints:
                raise UnknownName(f"joint of {urdf}", name, joints)
            _lock(joints[name])
        for name, (link, position) in self.frames.items():
            if link not in links:
                raise UnknownName(f"link of {urdf}", link, links)
            _add_frame(robot, name, link, position)
        if self.root:
            if self.root not in links:
                raise UnknownName(f"link of {urdf}", self.root, links)
            _reroot(robot, self.root)
        for mesh in robot.iter("mesh"):
            mesh.set("filename", str(resource(mesh.get("filename", ""), urdf)))


def _cache() -> Path:
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "ghc_controller" / "urdf"


def _write(target: Path, text: str) -> None:
    part = target.with_suffix(f".{os.getpid()}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(text, encoding="utf-8")
        part.replace(target)  # several nodes may write the same file at once
    except OSError as error:
        raise ConfigurationError(f"{target}: cannot be written: {error.strerror}") from error


def _lock(joint: Element) -> None:
    joint.set("type", "fixed")
    for child in list(joint):
        if child.tag not in ("origin", "parent", "child"):
            joint.remove(child)


def _add_frame(robot: Element, name: str, link: str, position: Array) -> None:
    ElementTree.SubElement(robot, "link", {"name": name})
    joint = ElementTree.SubElement(robot, "joint", {"name": f"{name}_fixed", "type": "fixed"})
    ElementTree.SubElement(joint, "parent", {"link": link})
    ElementTree.SubElement(joint, "child", {"link": name})
    place = np.eye(4)
    place[:3, 3] = position
    _set_origin(joint, place)


def _reroot(robot: Element, root: str) -> None:
    """Turn the joints between `root` and the old base around.

    A link's frame stands at the joint to its parent. On the way from the root up, each link P
    above a joint with origin T becomes the child: its frame moves to P T, where the joint is, and
    the joint turns about the opposite axis.
    """
    above = {_link(joint, "child"): joint for joint in robot.iterfind("joint")}
    moved = {root: np.eye(4)}  # link -> its new frame in its old one
    turned = []
    while (child := next(reversed(moved))) in above:
        joint = above[child]
        turned.append((joint, child))
        moved[_link(joint, "parent")] = _origin(joint)
    ways = {id(joint) for joint, _ in turned}
    for joint in robot.iterfind("joint"):
        parent = _link(joint, "parent")
        if id(joint) not in ways and parent in moved:
            _set_origin(joint, _inverse(moved[parent]) @ _origin(joint))
    for link in robot.iterfind("link"):
        if link.get("name", "") in moved:
            back = _inverse(moved[link.get("name", "")])
            for part in link:
                if part.tag in ("inertial", "visual", "collision"):
                    _set_origin(part, back @ _origin(part))
    for joint, child in turned:
        parent = _link(joint, "parent")
        _set_origin(joint, _inverse(moved[child]))
        joint.find("parent").set("link", child)  # type: ignore[union-attr]
        joint.find("child").set("link", parent)  # type: ignore[union-attr]
        axis = joint.find("axis")
        if axis is not None:
            axis.set("xyz", _numbers(-_vector(axis.get("xyz", "1 0 0"))))


def _link(joint: Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")


def _origin(element: Element) -> Array:
    """(4, 4) of the `origin` of a joint or of a part of a link."""
    place = np.eye(4)
    origin = element.find("origin")
    if origin is not None:
        roll, pitch, yaw = _vector(origin.get("rpy", "0 0 0"))
        place[:3, :3] = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
        place[:3, 3] = _vector(origin.get("xyz", "0 0 0"))
    return place


def _set_origin(element: Element, place: Array) -> None:
    origin = element.find("origin")
    if origin is None:
        origin = ElementTree.Element("origin")
        element.insert(0, origin)
    origin.set("xyz", _numbers(place[:3, 3]))
    origin.set("rpy", _numbers(_roll_pitch_yaw(place[:3, :3])))


def _inverse(place: Array) -> Array:
    inverse = np.eye(4)
    inverse[:3, :3] = place[:3, :3].T
    inverse[:3, 3] = -place[:3, :3].T @ place[:3, 3]
    return inverse


def _turn(axis: int, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[a, a] = turn[b, b] = c
    turn[b, a], turn[a, b] = s, -s
    return turn


def _roll_pitch_yaw(turn: Array) -> Array:
    level = float(np.hypot(turn[0, 0], turn[1, 0]))
    pitch = np.arctan2(-turn[2, 0], level)
    if level < _LEVEL:
        return np.array([0.0, pitch, np.arctan2(-turn[0, 1], turn[1, 1])])
    roll, yaw = np.arctan2(turn[2, 1], turn[2, 2]), np.arctan2(turn[1, 0], turn[0, 0])
    return np.array([roll, pitch, yaw])


def _vector(text: str) -> Array:
    return np.array([float(part) for part in text.split()])


def _numbers(values: Array) -> str:
    return " ".join(f"{value:.17g}" for value in values)

"""A URDF with another root, locked joints and additional frames.

Features that the controller does not support are simplified with a warning: mimic joints are
fixed, continuous joints get limits, xacro is expanded.

A legged robot that stands on one foot is an arm whose base is that foot. The changed URDF is
written to the user's cache, once for each content, so that controller and simulator read one file.
"""

from __future__ import annotations

import hashlib
import logging
import os
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robot.urdf_frames import inverse, numbers, origin_of, set_origin, vector
from ghc_controller.robot.urdf_joints import check_limits, lock, simplify_joints
from ghc_controller.robot.urdf_text import (
    cache,
    is_translated,
    parse_urdf,
    place_meshes,
    urdf_text,
)
from ghc_controller.types import Array

_LOG = logging.getLogger(__name__)
_FORMAT = "2"  # of what is written: a new number makes old files of the cache unused


@dataclass(frozen=True, slots=True)
class UrdfChanges:
    """Changes requested by a robot.yaml; none by default."""

    root: str = ""  # link that becomes the base; "" = that of the file
    locked: tuple[str, ...] = ()  # joints that stay at zero
    frames: dict[str, tuple[str, Array]] = field(default_factory=dict)
    # name -> link, and position (3,) [m] of a frame in it, with its axes

    def write(self, urdf: Path) -> Path:
        """Path of the changed URDF; that of `urdf` itself if nothing changes.

        Raises:
            UnknownName: a link or joint that is not in the URDF.
            ConfigurationError: no URDF, one that cannot be expanded, or the changed one cannot be
                written.
        """
        own = self.root or self.locked or self.frames
        if not urdf.is_file() and not own:
            return urdf  # reported when it is opened
        text = urdf_text(urdf)
        robot = parse_urdf(urdf, text)
        if own:
            self._change(robot, urdf)
        check_limits(robot, urdf)
        simpler = simplify_joints(robot)
        if str(simpler):
            _LOG.warning("%s: %s", urdf.name, simpler)
        elif not (own or is_translated(urdf)):
            return urdf
        frames = {name: (link, at.tolist()) for name, (link, at) in self.frames.items()}
        key = repr((_FORMAT, str(urdf), self.root, self.locked, frames)).encode()
        target = cache() / f"{urdf.stem}_{hashlib.sha256(key + text).hexdigest()[:16]}.urdf"
        if not target.is_file():
            place_meshes(robot, urdf)
            _write(target, ElementTree.tostring(robot, encoding="unicode"))
        return target

    def _change(self, robot: Element, urdf: Path) -> None:
        joints = {joint.get("name", ""): joint for joint in robot.iterfind("joint")}
        links = {link.get("name", ""): link for link in robot.iterfind("link")}
        for name in self.locked:
            if name not in joints:
                raise UnknownName(f"joint of {urdf}", name, joints)
            lock(joints[name])
        for name, (link, position) in self.frames.items():
            if link not in links:
                raise UnknownName(f"link of {urdf}", link, links)
            _add_frame(robot, name, link, position)
        if self.root:
            if self.root not in links:
                raise UnknownName(f"link of {urdf}", self.root, links)
            _reroot(robot, self.root)


def _write(target: Path, text: str) -> None:
    part = target.with_suffix(f".{os.getpid()}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(text, encoding="utf-8")
        part.replace(target)  # several nodes may write the same file at once
    except OSError as error:
        raise ConfigurationError(f"{target}: cannot be written: {error.strerror}") from error


def _add_frame(robot: Element, name: str, link: str, position: Array) -> None:
    ElementTree.SubElement(robot, "link", {"name": name})
    joint = ElementTree.SubElement(robot, "joint", {"name": f"{name}_fixed", "type": "fixed"})
    ElementTree.SubElement(joint, "parent", {"link": link})
    ElementTree.SubElement(joint, "child", {"link": name})
    place = np.eye(4)
    place[:3, 3] = position
    set_origin(joint, place)


def _reroot(robot: Element, root: str) -> None:
    """Reverse the joints between `root` and the old base.

    A link's frame is at the joint to its parent. From the root upwards, each link P
    above a joint with origin T becomes the child: its frame moves to P T, where the joint is, and
    the joint rotates about the opposite axis.
    """
    above = {_link(joint, "child"): joint for joint in robot.iterfind("joint")}
    moved = {root: np.eye(4)}  # link -> its new frame in its old one
    turned = []
    while (child := next(reversed(moved))) in above:
        joint = above[child]
        turned.append((joint, child))
        moved[_link(joint, "parent")] = origin_of(joint)
    ways = {id(joint) for joint, _ in turned}
    for joint in robot.iterfind("joint"):
        parent = _link(joint, "parent")
        if id(joint) not in ways and parent in moved:
            set_origin(joint, inverse(moved[parent]) @ origin_of(joint))
    for link in robot.iterfind("link"):
        if link.get("name", "") in moved:
            back = inverse(moved[link.get("name", "")])
            for part in link:
                if part.tag in ("inertial", "visual", "collision"):
                    set_origin(part, back @ origin_of(part))
    for joint, child in turned:
        parent = _link(joint, "parent")
        set_origin(joint, inverse(moved[child]))
        joint.find("parent").set("link", child)  # type: ignore[union-attr]
        joint.find("child").set("link", parent)  # type: ignore[union-attr]
        axis = joint.find("axis")
        if axis is not None:
            axis.set("xyz", numbers(-vector(axis.get("xyz", "1 0 0"))))


def _link(joint: Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else element.get("link", "")

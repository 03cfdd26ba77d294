"""Simplified joints of a URDF: mimic joints are fixed, continuous ones get limits."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.urdf_frames import origin_of, set_origin, turn_about, vector

TURNS = 100.0  # [-] either way that a continuous joint may turn; its limits are 2 pi times that


class SimplerJoints(NamedTuple):
    """Names of the joints of a URDF that were replaced."""

    held: tuple[str, ...]  # mimic joints: fixed where the joint that they follow is at zero
    bounded: tuple[str, ...]  # continuous joints: revolute within TURNS turns

    def __str__(self) -> str:
        """What was replaced, for a log; empty if nothing was."""
        parts = []
        if self.held:
            parts.append(f"mimic joints are held still: {', '.join(self.held)}")
        if self.bounded:
            names = ", ".join(self.bounded)
            parts.append(f"continuous joints may turn {TURNS:g} times either way: {names}")
        return "; ".join(parts)


def simplify_joints(robot: Element) -> SimplerJoints:
    """Replace them in place. A joint that is already fixed is unchanged."""
    held, bounded = [], []
    for joint in robot.iterfind("joint"):
        name, kind = joint.get("name", ""), joint.get("type")
        mimic = joint.find("mimic")
        if mimic is not None and kind != "fixed":
            _hold(joint, kind or "", float(mimic.get("offset") or 0.0))
            held.append(name)
        elif kind == "continuous":
            _bound(joint)
            bounded.append(name)
    return SimplerJoints(tuple(held), tuple(bounded))


def check_limits(robot: Element, urdf: Path) -> None:
    """Raise ConfigurationError for a joint that needs a limit and has none."""
    for joint in robot.iterfind("joint"):
        kind = joint.get("type")
        needs = kind in ("revolute", "prismatic") and joint.find("mimic") is None
        if needs and joint.find("limit") is None:
            raise ConfigurationError(
                f"{urdf}: joint '{joint.get('name', '')}' is {kind} and has no <limit>; lower, "
                "upper, effort and velocity expected (type 'continuous' needs no lower and upper)"
            )


def lock(joint: Element) -> None:
    """Fix a joint at zero."""
    joint.set("type", "fixed")
    for child in list(joint):
        if child.tag not in ("origin", "parent", "child"):
            joint.remove(child)


def _hold(joint: Element, kind: str, offset: float) -> None:
    """Fix a joint at its offset [rad] or [m]: a fixed joint whose origin holds the motion."""
    axis = joint.find("axis")
    direction = vector("1 0 0" if axis is None else axis.get("xyz", "1 0 0"))
    motion = np.eye(4)
    if kind == "prismatic":
        motion[:3, 3] = offset * direction / np.linalg.norm(direction)
    else:
        motion[:3, :3] = turn_about(direction, offset)
    set_origin(joint, origin_of(joint) @ motion)
    lock(joint)


def _bound(joint: Element) -> None:
    joint.set("type", "revolute")
    limit = joint.find("limit")
    if limit is None:
        limit = SubElement(joint, "limit", {"effort": "0", "velocity": "0"})
    limit.set("lower", f"{-TURNS * 2.0 * np.pi:.17g}")
    limit.set("upper", f"{TURNS * 2.0 * np.pi:.17g}")

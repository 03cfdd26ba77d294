"""Joints of a URDF in file order, with their limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from ghc_controller.errors import ConfigurationError

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class JointLimits:
    """Limits of one joint; infinite where the URDF gives none."""

    position: tuple[float, float]  # [rad] lower, upper
    velocity: float  # [rad/s]
    torque: float  # [Nm]


def read_limits(urdf: Path) -> dict[str, JointLimits]:
    """Moving joints in the order of the file, with their limits.

    Raises ConfigurationError when the file is no URDF or a limit is no number.
    """
    try:
        root = ElementTree.parse(urdf).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise ConfigurationError(f"{urdf}: cannot be read as XML: {error}") from error
    return {
        joint.get("name", ""): _limits(joint, urdf)
        for joint in root.iter("joint")
        if joint.get("type") in MOVING
    }


def _limits(joint: ElementTree.Element, urdf: Path) -> JointLimits:
    limit = joint.find("limit")
    given = {} if limit is None else limit.attrib
    try:
        lower, upper = float(given.get("lower", "0")), float(given.get("upper", "0"))
        velocity = float(given.get("velocity", "inf"))
        torque = float(given.get("effort", "inf"))
    except ValueError as error:
        raise ConfigurationError(f"{urdf}: joint '{joint.get('name')}': {error}") from error
    if joint.get("type") == "continuous":
        lower, upper = -math.inf, math.inf
    return JointLimits((lower, upper), velocity, torque)

"""Placements in a URDF: `origin` elements as homogeneous matrices."""

from __future__ import annotations

from xml.etree.ElementTree import Element

import numpy as np

from ghc_controller.types import Array

_LEVEL = 1e-9  # [-] cosine of the pitch below which roll and yaw are one angle


def origin_of(element: Element) -> Array:
    """(4, 4) of the `origin` of a joint or of a part of a link."""
    place = np.eye(4)
    origin = element.find("origin")
    if origin is not None:
        roll, pitch, yaw = vector(origin.get("rpy", "0 0 0"))
        place[:3, :3] = _turn(2, yaw) @ _turn(1, pitch) @ _turn(0, roll)
        place[:3, 3] = vector(origin.get("xyz", "0 0 0"))
    return place


def set_origin(element: Element, place: Array) -> None:
    origin = element.find("origin")
    if origin is None:
        origin = Element("origin")
        element.insert(0, origin)
    origin.set("xyz", numbers(place[:3, 3]))
    origin.set("rpy", numbers(_roll_pitch_yaw(place[:3, :3])))


def inverse(place: Array) -> Array:
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


def turn_about(axis: Array, angle: float) -> Array:
    """(3, 3) rotation by an angle [rad] about an axis (3,) of any length (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return turn


def turn_of(quaternion: Array) -> Array:
    """(3, 3) rotation of a unit quaternion w, x, y, z, the order of MuJoCo."""
    w, x, y, z = quaternion
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross
    return turn


def placed(position: Array, quaternion: Array) -> Array:
    """(4, 4) of a position [m] and a unit quaternion w, x, y, z."""
    place = np.eye(4)
    place[:3, :3] = turn_of(quaternion)
    place[:3, 3] = position
    return place


def _roll_pitch_yaw(turn: Array) -> Array:
    level = float(np.hypot(turn[0, 0], turn[1, 0]))
    pitch = np.arctan2(-turn[2, 0], level)
    if level < _LEVEL:
        return np.array([0.0, pitch, np.arctan2(-turn[0, 1], turn[1, 1])])
    roll, yaw = np.arctan2(turn[2, 1], turn[2, 2]), np.arctan2(turn[1, 0], turn[0, 0])
    return np.array([roll, pitch, yaw])


def vector(text: str) -> Array:
    return np.array([float(part) for part in text.split()])


def numbers(values: Array) -> str:
    return " ".join(f"{value:.17g}" for value in values)

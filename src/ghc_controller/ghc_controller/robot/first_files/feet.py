"""Which links of a legged robot are its feet, and where they touch level ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.model.shapes import link_points
from ghc_controller.robot.urdf_text import parse_urdf, resource_path
from ghc_controller.types import Array

_LEVEL = 0.03  # [m] height between the lowest points of all feet
_REACH = 0.25  # [m] height of a foot's frame above the lowest one
_SOLE = 0.01  # [m] thickness of the layer of a foot that touches the ground
_POINT = 0.06  # [m] extent up to which a foot is one point
_INSIDE = 0.9  # [-] of a sole's extent that is counted on
_ABOVE = 0.1  # [m] that the base's shape ends above the ground
_LEG_JOINTS = 3  # [-] that carry a foot at least


@dataclass(frozen=True)
class Foot:
    """A link that stands on the ground."""

    frame: str
    points: Array  # (1 or 4, 3) [m] in the frame
    up: Array  # (3,) direction away from the ground, in the frame
    joints: frozenset[int]  # velocity coordinates that move it


def shapes_of(urdf: Path, model: RobotModel, q: Array) -> dict[str, Array]:
    """Link -> (k, 4) points of its shape with their radii, as `link_points`.

    Of the base, and of the links that are low at configuration q (nq,): others are no feet.

    Raises:
        ConfigurationError: a mesh that cannot be read.
    """
    model.update(q, np.zeros(model.nv))
    heights = {name: model.frame_position(model.frame_id(name))[2] for name in model.frame_names}
    near = min(heights.values()) + _REACH
    robot = parse_urdf(urdf)
    names = {mesh.get("filename", "") for mesh in robot.iter("mesh")}
    files = {name: resource_path(name, urdf) for name in names}
    found = {}
    for link in robot.findall("link"):
        name = link.get("name", "")
        if name in heights and (heights[name] < near or not movers(model, name)):
            found[name] = link_points(link, files)
    return {name: points for name, points in found.items() if len(points)}


def find_feet(model: RobotModel, shapes: Mapping[str, Array], q: Array) -> tuple[Foot, ...]:
    """Feet of a robot at configuration q (nq,) with the base level; () where it has no legs.

    Feet are the links that end lowest, at least two of them on limbs of their own, below a base
    that does not reach down to the ground.

    Args:
        shapes: see `shapes_of`.
    """
    model.update(q, np.zeros(model.nv))
    placed = {name: _world(model, name, points) for name, points in shapes.items()}
    moved = {name: movers(model, name) for name in placed}
    ground = min((lowest(points) for points in placed.values()), default=0.0)
    base = [lowest(points) for name, points in placed.items() if not moved[name]]
    if min(base, default=np.inf) < ground + _ABOVE:
        return ()
    limbs: dict[frozenset[int], list[str]] = {}
    for name, points in placed.items():
        if lowest(points) < ground + _LEVEL and len(moved[name]) >= _LEG_JOINTS:
            limbs.setdefault(moved[name], []).append(name)
    ends = [joints for joints in limbs if not any(joints < other for other in limbs)]
    if len(ends) < 2 or any(one & other for one in ends for other in ends if one is not other):
        return ()
    return tuple(_foot(model, {name: placed[name] for name in limbs[end]}, end) for end in ends)


def lowest(points: Array) -> float:
    """Height [m] at which balls (k, 4) end."""
    return float((points[:, 2] - points[:, 3]).min())


def _foot(model: RobotModel, links: Mapping[str, Array], joints: frozenset[int]) -> Foot:
    frame = min(links, key=lambda name: lowest(links[name]))
    points = np.concatenate(list(links.values()))
    bottom = lowest(points)
    touching = points[points[:, 2] - points[:, 3] < bottom + _SOLE]
    low, high = touching[:, :2].min(axis=0), touching[:, :2].max(axis=0)
    middle, half = 0.5 * (low + high), 0.5 * _INSIDE * (high - low)
    if (high - low).max() <= _POINT:
        deepest = points[np.argmin(points[:, 2] - points[:, 3])]
        corners = np.array([[*deepest[:2], bottom]])
    else:
        signs = ((1, 1), (1, -1), (-1, -1), (-1, 1))
        corners = np.array([[*(middle + half * np.array(sign)), bottom] for sign in signs])
    index = model.frame_id(frame)
    rotation = model.frame_rotation(index)
    local = (corners - model.frame_position(index)) @ rotation
    return Foot(frame, local, rotation[2].copy(), joints)


def _world(model: RobotModel, name: str, points: Array) -> Array:
    index = model.frame_id(name)
    placed = points.copy()
    placed[:, :3] = points[:, :3] @ model.frame_rotation(index).T + model.frame_position(index)
    return placed


def movers(model: RobotModel, name: str) -> frozenset[int]:
    """Joints (velocity coordinates) that move a link against the base."""
    jacobian = model.frame_jacobian(model.frame_id(name))
    first = model.nv - model.na
    columns = np.abs(jacobian[:, first:]).max(axis=0) > 0.0
    return frozenset(int(column) + first for column in np.flatnonzero(columns))

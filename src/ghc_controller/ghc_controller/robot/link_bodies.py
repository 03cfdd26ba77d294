"""Bodies from the collision shapes of a URDF, for distances between them."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from ghc_controller.model.rounded_shape import Shape
from ghc_controller.model.shapes import link_points
from ghc_controller.robot.urdf_text import parse_urdf, resource_path
from ghc_controller.types import Array


def link_bodies(urdf: Path, names: Collection[str]) -> dict[str, tuple[Shape, ...]]:
    """Link -> a shape for each of its collision elements; links without any are left out.

    Spheres, capsules and boxes stay what they are. A cylinder becomes the capsule about it. A mesh
    becomes a capsule along its longest extent that contains all of its points.

    Raises:
        ConfigurationError: no URDF, or a mesh that cannot be read.
    """
    robot = parse_urdf(urdf)
    meshes = {mesh.get("filename", "") for mesh in robot.iter("mesh")}
    files = {mesh: resource_path(mesh, urdf) for mesh in meshes}
    found = {}
    for link in robot.findall("link"):
        if link.get("name", "") not in names:
            continue
        shapes = [_shape(element, files) for element in link.findall("collision")]
        known = tuple(shape for shape in shapes if shape is not None)
        if known:
            found[link.get("name", "")] = known
    return found


def _shape(element: Element, files: dict[str, Path]) -> Shape | None:
    geometry = element.find("geometry")
    kind = None if geometry is None else next(iter(geometry), None)
    if kind is None:
        return None
    origin = element.find("origin")
    place, rotation = np.zeros(3), np.eye(3)
    if origin is not None:
        place = _numbers(origin, "xyz")
        rotation = np.asarray(pin.rpy.rpyToMatrix(_numbers(origin, "rpy")))
    if kind.tag == "box":
        return Shape.box(place, _numbers(kind, "size"), rotation)
    if kind.tag == "sphere":
        return Shape(place, np.zeros((3, 0)), float(kind.get("radius", "0")))
    if kind.tag in ("cylinder", "capsule"):
        half = 0.5 * float(kind.get("length", "0")) * rotation[:, 2]
        return Shape.capsule(place - half, place + half, float(kind.get("radius", "0")))
    alone = Element("link")
    alone.append(element)
    points = link_points(alone, files)[:, :3]
    return enclosing_capsule(points) if len(points) else None


def enclosing_capsule(points: Array) -> Shape:
    """A capsule along the longest extent of points (k, 3) [m] that contains them all."""
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    axis = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0]
    along = (points - center) @ axis
    across = np.linalg.norm(points - center - np.outer(along, axis), axis=1)
    radius = float(across.max())
    low, high = float(along.min()) + radius, float(along.max()) - radius
    if low > high:  # thicker than long
        low = high = 0.5 * (low + high)
    start, end = center + low * axis, center + high * axis
    return Shape.capsule(start, end, float(_distances(points, start, end).max()))


def _distances(points: Array, start: Array, end: Array) -> Array:
    """(k,) [m] of points from a segment."""
    way = end - start
    share = np.clip((points - start) @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - np.outer(share, way), axis=1))


def _numbers(element: Element, name: str) -> Array:
    return np.array([float(word) for word in (element.get(name) or "0 0 0").split()])

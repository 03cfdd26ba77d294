"""Where the links of a URDF end: points of their shapes, each with a radius."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import pinocchio as pin

from ghc_controller.errors import ConfigurationError
from ghc_controller.types import Array

_STL_HEAD = 84  # [bytes] of a binary STL, its number of triangles at the end
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_AROUND = 16  # [-] points on the edge of a cylinder


def link_points(link: Element, files: dict[str, Path]) -> Array:
    """(k, 4) points of a link [m] in its frame and the radius about each [m].

    The convex hull of these balls is that of the link's collision shapes; of its visual ones
    where it has none.

    Args:
        link: element of a URDF.
        files: mesh as the URDF names it -> file.

    Raises:
        ConfigurationError: a mesh that cannot be read.
    """
    shapes = link.findall("collision") or link.findall("visual")
    found = [_points(shape, files) for shape in shapes]
    return np.concatenate(found) if found else np.zeros((0, 4))


def _points(shape: Element, files: dict[str, Path]) -> Array:
    geometry = shape.find("geometry")
    kind = None if geometry is None else next(iter(geometry), None)
    if kind is None:
        return np.zeros((0, 4))
    origin = shape.find("origin")
    place = pin.SE3.Identity()
    if origin is not None:
        place.translation = _numbers(origin, "xyz")
        place.rotation = pin.rpy.rpyToMatrix(_numbers(origin, "rpy"))
    points = _local(kind, files)
    points[:, :3] = points[:, :3] @ place.rotation.T + place.translation
    return points


def _local(kind: Element, files: dict[str, Path]) -> Array:
    if kind.tag == "box":
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        return _with_radius(0.5 * signs * _numbers(kind, "size"), 0.0)
    if kind.tag == "sphere":
        return _with_radius(np.zeros((1, 3)), float(kind.get("radius", "0")))
    if kind.tag in ("cylinder", "capsule"):
        radius, half = float(kind.get("radius", "0")), 0.5 * float(kind.get("length", "0"))
        if kind.tag == "capsule":
            return _with_radius(np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]), radius)
        angle = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)
        circle = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
        ends = [np.column_stack([circle, np.full(_AROUND, z)]) for z in (-half, half)]
        return _with_radius(np.concatenate(ends), 0.0)
    name = kind.get("filename", "")
    file = files.get(name)
    if kind.tag != "mesh" or file is None or not file.is_file():
        return np.zeros((0, 4))  # check_robot names a mesh that is missing
    scale = _numbers(kind, "scale") if kind.get("scale") else np.ones(3)
    return _with_radius(_vertices(file) * scale, 0.0)


def _vertices(file: Path) -> Array:
    """(k, 3) of a mesh; a binary STL is read here, which is much quicker."""
    content = file.read_bytes()
    count = int.from_bytes(content[80:84], "little")
    if file.suffix.lower() == ".stl" and len(content) == _STL_HEAD + count * _TRIANGLE.itemsize:
        corners = np.frombuffer(content, _TRIANGLE, offset=_STL_HEAD)["corners"]
        return corners.reshape(-1, 3).astype(np.float64)
    try:
        coal = import_module("coal")
        vertices = coal.MeshLoader().load(str(file), np.ones(3)).vertices()
    except ImportError as error:
        raise ConfigurationError(
            f"{file}: only binary STL is read without the Python package 'coal': "
            "`pip install coal`"
        ) from error
    except Exception as error:  # of any class: a mesh may be anything
        raise ConfigurationError(f"{file}: the mesh cannot be read: {error}") from error
    return np.array(vertices).reshape(-1, 3)


def _with_radius(points: Array, radius: float) -> Array:
    return np.column_stack([points, np.full(len(points), radius)]).astype(np.float64)


def _numbers(element: Element, name: str) -> Array:
    return np.array([float(word) for word in (element.get(name) or "0 0 0").split()])

"""Visual shapes of an MJCF, as `visual` elements of a URDF; meshes as STL files."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.urdf_frames import numbers, placed, set_origin

_SPHERE, _CAPSULE, _CYLINDER, _BOX, _MESH = 2, 3, 5, 6, 7  # mjtGeom
_SEEN = 2  # last group that MuJoCo draws by default


def add_shapes(robot: Element, model: Any, names: list[str], meshes: Path) -> None:
    """Add the visible shapes of each body to its link, except planes, height fields and
    ellipsoids.

    Raises:
        ConfigurationError: a mesh cannot be written.
    """
    links = {link.get("name", ""): link for link in robot.iterfind("link")}
    files: dict[int, Path] = {}
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        link = links.get(names[body])
        geometry = _geometry(model, geom, meshes, files)
        if body == 0 or link is None or geometry is None or model.geom_group[geom] > _SEEN:
            continue
        visual = SubElement(link, "visual")
        set_origin(visual, placed(model.geom_pos[geom], model.geom_quat[geom]))
        SubElement(visual, "geometry").append(geometry)
        material = SubElement(visual, "material", {"name": f"color_{geom}"})
        SubElement(material, "color", {"rgba": numbers(model.geom_rgba[geom].astype(float))})


def _geometry(model: Any, geom: int, meshes: Path, files: dict[int, Path]) -> Element | None:
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == _SPHERE:
        return Element("sphere", {"radius": f"{size[0]:.9g}"})
    if kind in (_CAPSULE, _CYLINDER):
        length = 2.0 * size[1]
        return Element("cylinder", {"radius": f"{size[0]:.9g}", "length": f"{length:.9g}"})
    if kind == _BOX:
        return Element("box", {"size": numbers(2.0 * size)})
    if kind == _MESH:
        mesh = int(model.geom_dataid[geom])
        if mesh not in files:
            files[mesh] = _write_mesh(model, mesh, meshes)
        return Element("mesh", {"filename": str(files[mesh])})
    return None


def _write_mesh(model: Any, mesh: int, folder: Path) -> Path:
    """Binary STL of a compiled mesh, in the frame that its geoms place."""
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    vertices = model.mesh_vert[first : first + count]
    first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    faces = model.mesh_face[first : first + count]
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    content = np.zeros(count, dtype=triangle)
    content["corners"] = vertices[faces]
    path = folder / f"{mesh}.stl"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_bytes(bytes(80) + np.uint32(count).tobytes() + content.tobytes())
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be written: {error.strerror}") from error
    return path

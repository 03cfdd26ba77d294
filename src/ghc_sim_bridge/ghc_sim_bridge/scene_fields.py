"""Readers of the parts of a scene file; every error names file and field."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ghc_sim_bridge.scene_values import (
    SURFACE_KINDS,
    BaseStart,
    Camera,
    Colour,
    Contact,
    Limit,
    Surface,
    Vector,
)
from ghc_sim_bridge.yaml_fields import Fields


def read_surface(fields: Fields) -> Surface:
    """One entry of `surfaces`."""
    kind = fields.text("kind")
    if kind not in SURFACE_KINDS:
        raise fields.error("kind", f"'{kind}' given, one of {', '.join(SURFACE_KINDS)} expected")
    plane = kind == "plane"
    touches = fields.value("touches", True)
    if not isinstance(touches, bool):
        raise fields.error("touches", f"true or false is expected, {touches!r} given")
    surface = Surface(
        name=fields.text("name"),
        kind=kind,
        top=read_vector(fields, "top", (0.0, 0.0, 0.0)),
        size=read_vector(fields, "size", (0.0, 0.0, 0.0) if plane else None),
        colour=_colour(fields, "colour", (0.8, 0.8, 0.8, 1.0)),
        touches=touches,
    )
    fields.close()
    if not plane and min(surface.size) <= 0.0:
        raise fields.error("size", f"lengths above 0 are expected, {surface.size} given")
    return surface


def read_contact(fields: Fields) -> Contact:
    """One entry of `contacts`."""
    points = fields.value("points", [[0.0, 0.0, 0.0]])
    if not isinstance(points, list) or not points:
        raise fields.error("points", f"a list of points is expected, {points!r} given")
    centres = Fields(
        {str(k): point for k, point in enumerate(points)}, fields.file, f"{fields.where}.points"
    )
    contact = Contact(
        name=fields.text("name"),
        frame=fields.text("frame"),
        radius=fields.number("radius", minimum=1e-4),
        points=tuple(read_vector(centres, str(k)) for k in range(len(points))),
        friction=fields.number("friction", 0.5, minimum=0.0),
        time_constant=fields.number("time_constant", 0.005, minimum=1e-4),
        damping_ratio=fields.number("damping_ratio", 1.0, minimum=0.0),
    )
    fields.close()
    return contact


def read_camera(fields: Fields) -> Camera:
    """The `camera`."""
    camera = Camera(
        look_at=read_vector(fields, "look_at"),
        distance=fields.number("distance", minimum=0.01),
        azimuth=fields.number("azimuth"),
        elevation=fields.number("elevation"),
        field_of_view=fields.number("field_of_view", 35.0, minimum=1.0),
    )
    fields.close()
    return camera


def read_base(fields: Fields) -> BaseStart:
    """The `base`."""
    frames = fields.value("stand_on")
    if not isinstance(frames, list) or not frames or not all(isinstance(f, str) for f in frames):
        raise fields.error("stand_on", f"a list of frames is expected, {frames!r} given")
    base = BaseStart(
        stand_on=tuple(frames),
        at=read_vector(fields, "at", (0.0, 0.0, 0.0)),
        heading=fields.number("heading", 0.0),
    )
    fields.close()
    return base


def read_limit(fields: Fields, name: str) -> Limit:
    """A limit of robot.yaml: one number, numbers by joint, or None for those of the URDF."""
    if not fields.has(name):
        return None
    if not isinstance(fields.value(name), Mapping):
        return fields.number(name)
    joints = fields.section(name)
    return {joint: joints.number(joint) for joint in joints.names()}


def read_vector(fields: Fields, name: str, default: Vector | None = None) -> Vector:
    """Three numbers; required when there is no default."""
    values = fields.vector(name) if default is None else fields.vector(name, default)
    if len(values) != 3:
        raise fields.error(name, f"3 numbers are expected, {len(values)} given")
    return values[0], values[1], values[2]


def _colour(fields: Fields, name: str, default: Colour) -> Colour:
    values = fields.vector(name, default)
    if len(values) != 4 or not all(math.isfinite(x) and 0.0 <= x <= 1.0 for x in values):
        raise fields.error(name, f"4 numbers of [0, 1] are expected, {values} given")
    return values[0], values[1], values[2], values[3]

"""Readers of the parts of a scene file; every error names file and field."""

from __future__ import annotations

from ghc_controller.schema.reader import Fields
from ghc_sim_bridge.scene.values import (
    SURFACE_KINDS,
    BaseStart,
    Camera,
    Colour,
    Contact,
    Surface,
    Vector,
)


def read_surface(fields: Fields) -> Surface:
    """One entry of `surfaces`."""
    kind = fields.choice("kind", SURFACE_KINDS)
    plane = kind == "plane"
    surface = Surface(
        name=fields.text("name"),
        kind=kind,
        top=read_vector(fields, "top", (0.0, 0.0, 0.0)),
        size=read_vector(fields, "size", (0.0, 0.0, 0.0) if plane else None),
        colour=_colour(fields, "colour", (0.8, 0.8, 0.8, 1.0)),
        touches=fields.flag("touches", True),
    )
    fields.done()
    if not plane and min(surface.size) <= 0.0:
        raise fields.error("size", f"lengths above 0 expected, {surface.size} given")
    return surface


def read_contact(fields: Fields) -> Contact:
    """One entry of `contacts`."""
    contact = Contact(
        name=fields.text("name"),
        frame=fields.text("frame"),
        radius=fields.number("radius", minimum=1e-4),
        points=tuple((x, y, z) for x, y, z in fields.vectors("points", 3, [(0.0, 0.0, 0.0)])),
        friction=fields.number("friction", 0.5, minimum=0.0),
        time_constant=fields.number("time_constant", 0.005, minimum=1e-4),
        damping_ratio=fields.number("damping_ratio", 1.0, minimum=0.0),
    )
    fields.done()
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
    fields.done()
    return camera


def read_base(fields: Fields) -> BaseStart:
    """The `base`."""
    base = BaseStart(
        stand_on=fields.names("stand_on", of="frames"),
        at=read_vector(fields, "at", (0.0, 0.0, 0.0)),
        heading=fields.number("heading", 0.0),
    )
    fields.done()
    return base


def read_vector(fields: Fields, name: str, default: Vector | None = None) -> Vector:
    """Three numbers; required when there is no default."""
    x, y, z = fields.vector(name, 3) if default is None else fields.vector(name, 3, default)
    return x, y, z


def _colour(fields: Fields, name: str, default: Colour) -> Colour:
    values = fields.vector(name, default=default)
    if len(values) != 4 or not all(0.0 <= x <= 1.0 for x in values):
        raise fields.error(name, f"4 numbers in [0, 1] expected, {list(values)} given")
    return values[0], values[1], values[2], values[3]

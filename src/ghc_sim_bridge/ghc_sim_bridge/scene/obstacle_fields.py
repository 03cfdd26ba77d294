"""Readers of a scene's obstacles and of the sensor that sees them."""

from __future__ import annotations

import math

from ghc_controller.schema.reader import Fields
from ghc_sim_bridge.scene.fields import read_vector
from ghc_sim_bridge.scene.values import Obstacle, Sighting, Vector

_LENGTH_TOLERANCE = 1e-3  # [-] how far the length of a given normal may be from 1


def read_sensor_period(fields: Fields) -> float | None:
    """Period [s] of the section `obstacle_sensor`; None for a scene without one.

    Raises ConfigurationError; also for obstacles that no sensor would see.
    """
    if not fields.has("obstacle_sensor"):
        if fields.sections("obstacles", optional=True):
            raise fields.error("obstacle_sensor", "missing: nothing sees the obstacles")
        return None
    sensor = fields.section("obstacle_sensor")
    period = sensor.number("period", 0.1, minimum=1e-3)
    sensor.done()
    return period


def read_obstacle(fields: Fields) -> Obstacle:
    """One entry of `obstacles`; ConfigurationError names file and field."""
    obstacle = Obstacle(
        id=fields.text("id"),
        protected_frame=fields.text("protected_frame"),
        safe_distance=fields.number("safe_distance", minimum=0.0),
        normal=_normal(fields) if fields.has("normal") else None,
        track=tuple(_sighting(entry) for entry in fields.sections("track")),
    )
    fields.done()
    for before, after in zip(obstacle.track, obstacle.track[1:], strict=False):
        if after.time <= before.time:
            raise fields.error(
                "track",
                f"increasing times expected, {after.time:g} s given after {before.time:g} s",
            )
    return obstacle


def _sighting(fields: Fields) -> Sighting:
    """An entry of `track`; the obstacle is not seen where `position` is left out."""
    position = read_vector(fields, "position") if fields.has("position") else None
    sighting = Sighting(fields.number("time", minimum=0.0), position)
    fields.done()
    return sighting


def _normal(fields: Fields) -> Vector:
    normal = read_vector(fields, "normal")
    length = math.hypot(*normal)
    if abs(length - 1.0) > _LENGTH_TOLERANCE:
        raise fields.error("normal", f"length 1 expected, {length:g} given")
    return normal[0] / length, normal[1] / length, normal[2] / length

"""Scripted references of the tasks: points of simulated time, sent before the start.

A static target is one point. A lemniscate is sampled densely enough for the controller's
interpolation between the points to follow it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ghc_controller.schema.reader import Fields

Vector = tuple[float, ...]
KINDS = ("position", "joints", "points", "lemniscate")


@dataclass(frozen=True, slots=True)
class ReferencePoint:
    """A point of a reference; m = rows of the task."""

    time: float  # [s] simulated
    position: Vector  # (m,) [m] or [rad]; empty = unchanged
    velocity: Vector = ()  # (m,) [m/s] or [rad/s]; empty = zero
    acceleration: Vector = ()  # (m,) [m/s^2] or [rad/s^2]; empty = zero
    wrench: Vector = ()  # (m,) [N] or [Nm] that the robot shall exert on its surroundings


@dataclass(frozen=True, slots=True)
class Lemniscate:
    """Lemniscate of Gerono: p = c + a sin(w t) + b sin(2 w t), with w = 2 pi / period."""

    center: Vector  # (3,) [m] c
    along: Vector  # (3,) [m] half axis a
    across: Vector  # (3,) [m] half axis b
    period: float  # [s]
    sample: float  # [s] between two points

    def point(self, time: float) -> ReferencePoint:
        """Position and its two derivatives at one instant [s]."""
        rate = 2.0 * math.pi / self.period
        s1, c1 = math.sin(rate * time), math.cos(rate * time)
        s2, c2 = math.sin(2.0 * rate * time), math.cos(2.0 * rate * time)
        axes = tuple(zip(self.center, self.along, self.across, strict=True))
        return ReferencePoint(
            time=time,
            position=tuple(c + a * s1 + b * s2 for c, a, b in axes),
            velocity=tuple(rate * (a * c1 + 2.0 * b * c2) for _, a, b in axes),
            acceleration=tuple(-(rate**2) * (a * s1 + 4.0 * b * s2) for _, a, b in axes),
        )


@dataclass(frozen=True, slots=True)
class Reference:
    """The reference of one named task over the whole run: given points or a lemniscate."""

    task: str
    points: tuple[ReferencePoint, ...] = ()
    joints: tuple[str, ...] = ()  # names of the columns of a posture reference
    lemniscate: Lemniscate | None = None

    def points_until(self, duration: float) -> tuple[ReferencePoint, ...]:
        """The points to be sent for a run of `duration` [s]."""
        if self.lemniscate is None:
            return self.points
        count = math.ceil(duration / self.lemniscate.sample) + 1
        return tuple(self.lemniscate.point(k * self.lemniscate.sample) for k in range(count))


def read_reference(task: str, fields: Fields) -> Reference:
    """The reference of one task from its section of a scenario file."""
    given = [kind for kind in KINDS if fields.has(kind)]
    if len(given) != 1:
        shown = ", ".join(given or fields.given()) or "nothing"
        raise fields.complaint(f"exactly one of {', '.join(KINDS)} expected, {shown} given")
    if given[0] == "position":
        reference = Reference(task, (ReferencePoint(0.0, fields.vector("position")),))
    elif given[0] == "joints":
        joints = fields.section("joints")
        values = tuple(joints.number(name) for name in joints.given())
        reference = Reference(task, (ReferencePoint(0.0, values),), joints.given())
    elif given[0] == "points":
        reference = Reference(task, _read_points(fields))
    else:
        reference = Reference(task, lemniscate=_read_lemniscate(fields.section("lemniscate")))
    fields.done()
    return reference


def _read_points(fields: Fields) -> tuple[ReferencePoint, ...]:
    points: list[ReferencePoint] = []
    for item in fields.sections("points"):
        point = ReferencePoint(
            time=item.number("time", minimum=0.0),
            position=item.vector("position", default=()),
            velocity=item.vector("velocity", default=()),
            acceleration=item.vector("acceleration", default=()),
            wrench=item.vector("wrench", default=()),
        )
        item.done()
        if points and point.time <= points[-1].time:
            expected = f"more than {points[-1].time:g} s (the point before) expected"
            raise item.error("time", f"{expected}, {point.time:g} given")
        points.append(point)
    return tuple(points)


def _read_lemniscate(fields: Fields) -> Lemniscate:
    lemniscate = Lemniscate(
        center=fields.vector("center", 3),
        along=fields.vector("along", 3),
        across=fields.vector("across", 3),
        period=fields.number("period", minimum=1e-3),
        sample=fields.number("sample", 0.1, minimum=1e-3),
    )
    fields.done()
    return lemniscate

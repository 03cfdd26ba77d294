"""Scripted task references: points in simulated time, sent before the start.

A static target is one point. A lemniscate is sampled densely enough for the controller's
interpolation to follow it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ghc_controller.errors import InvalidField
from ghc_controller.schema.declared import declared, entries
from ghc_controller.schema.domains import NOT_NEGATIVE, Range
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read

Vector = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ReferencePoint:
    """A point of a reference; m = rows of the task."""

    time: float = declared("simulated", unit="s", domain=NOT_NEGATIVE)
    position: Vector = declared("(m,) [m] or [rad]; left out = unchanged", fallback=())
    velocity: Vector = declared("(m,) [m/s] or [rad/s]; left out = zero", ())
    acceleration: Vector = declared("(m,) [m/s^2] or [rad/s^2]; left out = zero", ())
    wrench: Vector = declared("(m,) [N] or [Nm] to exert on the environment", ())


@dataclass(frozen=True, slots=True)
class Lemniscate:
    """Lemniscate of Gerono: p = c + a sin(w t) + b sin(2 w t), with w = 2 pi / period."""

    center: Vector = declared("c", unit="m", size=3)
    along: Vector = declared("half axis a", unit="m", size=3)
    across: Vector = declared("half axis b", unit="m", size=3)
    period: float = declared("of the curve", unit="s", domain=Range(minimum=1e-3))
    sample: float = declared(
        "between two points", unit="s", domain=Range(minimum=1e-3), fallback=0.1
    )

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
        """The points for a run of `duration` [s]."""
        if self.lemniscate is None:
            return self.points
        count = math.ceil(duration / self.lemniscate.sample) + 1
        return tuple(self.lemniscate.point(k * self.lemniscate.sample) for k in range(count))


@dataclass(frozen=True, slots=True)
class ReferenceFields:
    """Reference of one task in a scenario file: exactly one of these fields."""

    position: Vector | None = declared("standing position [m] or [rad]", None)
    joints: Mapping[str, float] | None = declared("joint: standing position", None, unit="rad")
    points: tuple[ReferencePoint, ...] = declared("increasing times", (), empty=False)
    lemniscate: Lemniscate | None = declared("a figure of eight", None)

    def __post_init__(self) -> None:
        """Raise InvalidField for points whose times do not increase."""
        for k, (before, after) in enumerate(zip(self.points, self.points[1:], strict=False)):
            if after.time <= before.time:
                expected = f"more than {before.time:g} s (the point before) expected"
                raise InvalidField(f"points[{k + 1}].time", f"{expected}, {after.time:g} given")

    def reference(self, task: str) -> Reference:
        """The corresponding reference."""
        if self.position is not None:
            return Reference(task, (ReferencePoint(0.0, self.position),))
        if self.joints is not None:
            point = ReferencePoint(0.0, tuple(self.joints.values()))
            return Reference(task, (point,), tuple(self.joints))
        return Reference(task, self.points, lemniscate=self.lemniscate)


KINDS = tuple(entry.name for entry in entries(ReferenceFields))


def read_references(scenario: Fields, name: str) -> tuple[Reference, ...]:
    """The section `references` of a scenario file: task -> its reference."""
    tasks = scenario.section(name, optional=True)
    return tuple(_read_reference(task, tasks.section(task)) for task in tasks.given())


def _read_reference(task: str, fields: Fields) -> Reference:
    given = [kind for kind in KINDS if fields.has(kind)]
    if len(given) != 1:
        shown = ", ".join(given or fields.given()) or "nothing"
        raise fields.complaint(f"exactly one of {', '.join(KINDS)} expected, {shown} given")
    return read(fields, ReferenceFields).reference(task)

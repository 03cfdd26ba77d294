"""Checked measurements of obstacles."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.errors import GhcError, InvalidValue, WrongSize
from ghc_controller.types import UNIT_TOLERANCE, Array


@dataclass(frozen=True, slots=True)
class Measurement:
    """One obstacle and the protected frame at one instant; constructed by `checked`."""

    id: str
    frame: str
    position: Array  # (3,) [m] closest point of the obstacle, world axes
    normal: Array  # (3,) unit, from that point to the protected frame
    distance: float  # [m] between the two
    safe_distance: float  # [m]

    @classmethod
    def checked(
        cls,
        id: str,  # noqa: A002 - name of the message field
        frame: str,
        position: Sequence[float],
        normal: Sequence[float],
        distance: float,
        safe_distance: float,
    ) -> Measurement:
        """Measurement with a normal of length 1.

        Raises:
            GhcError: no name, wrong size, not finite, no unit normal, negative distance.
        """
        where = f"obstacle '{id}'"
        if not id or not frame:
            raise InvalidValue(f"{where}: protected frame '{frame}' given, two names expected")
        vectors = {}
        for name, values in (("position", position), ("normal", normal)):
            vectors[name] = np.array(values, dtype=np.float64)
            if vectors[name].shape != (3,):
                raise WrongSize(f"{where}, {name}", len(values), 3)
            if not np.isfinite(vectors[name]).all():
                raise InvalidValue(
                    f"{where}: {name} = {vectors[name].tolist()} given, finite numbers expected"
                )
        length = float(np.linalg.norm(vectors["normal"]))
        if abs(length - 1.0) > UNIT_TOLERANCE:
            raise InvalidValue(f"{where}: normal of length {length:g} given, 1 expected")
        for name, value in (("distance", distance), ("safe_distance", safe_distance)):
            if not (np.isfinite(value) and value >= 0.0):
                raise InvalidValue(f"{where}: {name} = {value} m given, 0 or more expected")
        return cls(
            id, frame, vectors["position"], vectors["normal"] / length, distance, safe_distance
        )

    @classmethod
    def read(cls, message: Any) -> Measurement:
        """Measurement of a ghc_msgs/ObstacleState; raises as `checked`."""
        return cls.checked(
            message.id,
            message.protected_frame,
            list(message.position),
            list(message.normal),
            message.distance,
            message.safe_distance,
        )

    def away(self, margin: float) -> Array:
        """Position (3,) on the normal at the safe distance plus a margin [m]."""
        room = self.safe_distance + margin - self.distance
        return self.position - room * self.normal

    def closer(self, by: float) -> Measurement:
        """The same obstacle, `by` [m] closer to the protected frame, at most touching it."""
        by = min(by, self.distance)
        return Measurement(
            self.id,
            self.frame,
            self.position + by * self.normal,
            self.normal,
            self.distance - by,
            self.safe_distance,
        )


@dataclass(frozen=True, slots=True)
class Measurements:
    """All obstacles measured at one instant."""

    seen: tuple[Measurement, ...]
    doubtful: tuple[str, ...] = ()  # ids with invalid measurements

    @classmethod
    def read(cls, message: Any, reject: Callable[[str], None]) -> Measurements:
        """Measurements of a ghc_msgs/ObstacleStateArray; only invalid entries are rejected."""
        seen: dict[str, Measurement] = {}
        doubtful = []
        for entry in message.obstacles:
            try:
                seen[entry.id] = Measurement.read(entry)
            except GhcError as error:
                reject(str(error))
                doubtful.append(entry.id)
        return cls(tuple(seen.values()), tuple(doubtful))


def frame_of(normal: Array) -> Array:
    """(3, 3) rows: away from the protected frame, and two tangents; a rotation of the world.

    Duff et al., *Building an orthonormal basis, revisited*: no square root, no special case.
    """
    x, y, z = (-normal).tolist()
    sign = math.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    first = (1.0 + sign * x * x * a, sign * b, -sign * x)
    second = (b, sign + y * y * a, -y)
    return np.array([(x, y, z), first, second])

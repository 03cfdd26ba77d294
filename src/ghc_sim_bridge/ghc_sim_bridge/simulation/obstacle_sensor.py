"""A slow sensor of obstacles: which of them it sees at an instant, how far away, and where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.types import NANOSECONDS, Array
from ghc_sim_bridge.scene.values import Obstacle, Vector

_TOUCHING = 1e-6  # [m] closer than this a point has no direction to the frame


@dataclass(frozen=True, slots=True)
class ObstacleReading:
    """One obstacle as the sensor has it; world axes."""

    id: str
    protected_frame: str
    position: Array  # (3,) [m] closest point; of a plane a point of it
    normal: Array  # (3,) unit, from the obstacle to the protected frame
    distance: float  # [m] along the normal, 0 or more
    safe_distance: float  # [m]


class ObstacleSensor:
    """Measures all obstacles at the multiples of its period, and nothing in between.

    A reading depends on the time, the frames, and on the direction from which a point came that
    now touches its frame: a repeated state is read alike.
    """

    def __init__(self, obstacles: Sequence[Obstacle], period: float, control_dt: float) -> None:
        """`period` [s] between readings, a multiple of `control_dt` [s]; else InvalidValue."""
        self._obstacles = tuple(obstacles)
        self._period_ns = round(period * NANOSECONDS)
        if self._period_ns % round(control_dt * NANOSECONDS):
            raise InvalidValue(
                f"obstacle sensor: period {period:g} s given, a multiple of the control period "
                f"({control_dt:g} s) expected"
            )
        self._normals: dict[str, Array] = {}
        self._read_ns = -1

    def is_due(self, stamp_ns: int) -> bool:
        """Whether there is a reading at `stamp_ns` [ns]."""
        return stamp_ns % self._period_ns == 0

    def read(
        self, stamp_ns: int, frame_position: Callable[[str], Array]
    ) -> tuple[ObstacleReading, ...]:
        """Everything that is seen at `stamp_ns` [ns]; empty when nothing is.

        `frame_position` gives the origin (3,) [m] of a frame of the robot by its name.
        """
        if stamp_ns < self._read_ns:  # time began again
            self._normals.clear()
        self._read_ns = stamp_ns
        readings = []
        for obstacle in self._obstacles:
            position = position_at(obstacle, stamp_ns)
            if position is not None:
                point, frame = np.array(position), frame_position(obstacle.protected_frame)
                readings.append(self._measure(obstacle, point, frame))
        return tuple(readings)

    def _measure(self, obstacle: Obstacle, point: Array, frame: Array) -> ObstacleReading:
        way = frame - point
        if obstacle.normal is not None:
            normal = np.array(obstacle.normal)
        elif (length := float(np.linalg.norm(way))) > _TOUCHING:
            normal = way / length
        else:
            normal = self._normals.get(obstacle.id, np.array([0.0, 0.0, 1.0]))
        self._normals[obstacle.id] = normal
        return ObstacleReading(
            obstacle.id,
            obstacle.protected_frame,
            point,
            normal,
            max(float(normal @ way), 0.0),
            obstacle.safe_distance,
        )


def position_at(obstacle: Obstacle, stamp_ns: int) -> Vector | None:
    """Where an obstacle is at `stamp_ns` [ns]; None while it is not seen."""
    position = None
    for sighting in obstacle.track:
        if round(sighting.time * NANOSECONDS) > stamp_ns:
            break
        position = sighting.position
    return position

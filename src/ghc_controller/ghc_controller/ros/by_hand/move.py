"""A target as reference points: a step, or a minimum-jerk move from the current reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ghc_controller.errors import ConfigurationError
from ghc_controller.references.point_files import Point, Points, Row
from ghc_controller.types import Array

# A minimum-jerk move over d in T seconds is fastest in its middle: 15/8 d / T.
_PEAK = 15.0 / 8.0


class Followed(Protocol):
    """Content of a TaskState."""

    name: str
    reference: Sequence[float]  # current, as TaskTarget.position
    error: Sequence[float]  # one entry per row


@dataclass(frozen=True)
class Move:
    """Target of a task. Without duration and velocity it is a step."""

    position: Row = ()  # [m] or [rad]
    quaternion: Row = ()  # x, y, z, w, of any length but 0
    wrench: Row = ()  # [N], [Nm]
    duration: float = 0.0  # [s]
    velocity: float = 0.0  # [m/s] or [rad/s] at most, of the reference; 0 = duration decides

    def points_from(self, task: Followed) -> Points:
        """One point, or the two ends of the move: quintic between them, at rest at both.

        The controller sets the first end: its reference at the time of acceptance.

        Raises:
            ConfigurationError: wrong size of the target.
        """
        size = len(task.reference)
        target = self._target()
        if len(target) not in ({0, size} if self.wrench else {size}):
            turns = " (an orientation is --quaternion X Y Z W)" if rows_of(task) < size else ""
            raise ConfigurationError(
                f"task '{task.name}': {len(target)} numbers given, {size} expected{turns}"
            )
        over = self.duration
        if self.velocity and target:
            over = _PEAK * _distance(np.array(task.reference), np.array(target), task)
            over /= self.velocity
        if over <= 0.0:
            return Points((Point(0.0, target, wrench=self.wrench),))
        rest = (0.0,) * rows_of(task)
        return Points(
            (
                Point(0.0, (), rest, rest, self.wrench),
                Point(over, target, rest, rest, self.wrench),
            )
        )

    def _target(self) -> Row:
        length = math.hypot(*self.quaternion)
        if self.quaternion and not length > 0.0:
            raise ConfigurationError("quaternion: 0 0 0 0 given, a direction expected")
        return (*self.position, *(value / length for value in self.quaternion))


def rows_of(task: Followed) -> int:
    """Entries of a velocity of the task; one less than of a position with a quaternion."""
    size = len(task.reference)
    return size - 1 if size in (4, 7) and len(task.error) == size - 1 else size


def _distance(start: Array, end: Array, task: Followed) -> float:
    """[m] or [rad] distance between two references; for a pose the larger of both."""
    if rows_of(task) == len(start):
        return float(np.linalg.norm(end - start))
    cosine = min(1.0, abs(float(start[-4:] @ end[-4:])))
    return max(2.0 * math.acos(cosine), float(np.linalg.norm(end[:-4] - start[:-4])))

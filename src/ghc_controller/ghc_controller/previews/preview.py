"""Planned bounds for the rows of one constraint over a horizon."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from enum import Enum
from itertools import compress

import numpy as np

from ghc_controller.core import native
from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array

CONTACT_FORCES = "contact_forces"
OBSTACLE_MOTION = "obstacle_motion"
JOINT_LIMITS = "joint_limits"
TORQUE_LIMITS = "torque_limits"
BODY_MARGINS = "body_margins"
KINDS = (CONTACT_FORCES, OBSTACLE_MOTION, JOINT_LIMITS, TORQUE_LIMITS, BODY_MARGINS)

AGE_TOLERANCE = 1e-9  # [s]


class StaleRule(Enum):
    """Rule after the last point of a preview; the value is used in messages."""

    OF_ROBOT = 0  # as robot.yaml says, otherwise HOLD
    HOLD = 1  # the last point
    RELEASE = 2  # what robot.yaml allows
    TIGHTEN = 3  # the tightest point of the preview


@dataclass(frozen=True, slots=True)
class Preview:
    """Bounds of r rows at the points start + j step, j = 0 .. N; or motions of r obstacles."""

    kind: str  # constraint that follows it
    start: float  # [s] time of the tick
    step: float  # [s] between points
    rows: tuple[str, ...]  # names of contacts, joints or obstacles
    lower: Array  # (r, N + 1) [N], [rad], [Nm]; of a motion the distance to be kept [m]
    upper: Array  # (r, N + 1)
    active: tuple[bool, ...]  # whether a row is on now
    status: tuple[PreviewStatus, ...]
    conflict: tuple[bool, ...]  # the input is contradictory within the horizon
    interpolate: bool  # false: each point holds until the next one; true: straight lines between
    motions: tuple[PlannedMotion, ...] = ()  # r of them, or none
    stale: StaleRule = StaleRule.OF_ROBOT
    name: str = ""  # of the generator

    @classmethod
    def of_motions(
        cls, start: float, step: float, steps: int, motions: tuple[PlannedMotion, ...]
    ) -> Preview:
        """Preview of obstacles that move for N = `steps`; then they rest."""
        distance = np.array([motion.safe_distance for motion in motions], dtype=np.float64)
        lower = np.broadcast_to(distance[:, None], (len(motions), steps + 1))
        return cls(
            OBSTACLE_MOTION,
            start,
            step,
            tuple(motion.id for motion in motions),
            lower,
            np.broadcast_to(np.inf, lower.shape),
            tuple(motion.moves for motion in motions),
            tuple(motion.status for motion in motions),
            (False,) * len(motions),
            True,
            motions,
        )

    def labeled(self, kind: str, stale: StaleRule, name: str) -> Preview:
        """The same under another kind, stale rule and name of its generator."""
        return replace(self, kind=kind, stale=stale, name=name)

    @property
    def valid_until(self) -> float:
        """Time [s] of the last point."""
        return self.start + self.step * (self.lower.shape[1] - 1)

    def has_ended(self, time: float) -> bool:
        """Whether the stale rule applies at a time [s]."""
        return time > self.valid_until + AGE_TOLERANCE

    def at(self, time: float) -> tuple[Array, Array]:
        """Lower and upper bounds (r,) at a time [s].

        Before the start the first point holds. After the end the last one does, or with TIGHTEN
        the tightest; OF_ROBOT and RELEASE are for the constraint to apply.
        """
        if self.stale is StaleRule.TIGHTEN and self.has_ended(time):
            upper = self.upper.min(axis=1)
            return np.minimum(self.lower.max(axis=1), upper), upper
        place = (time - self.start) / self.step
        return native.bounds_at(self.lower, self.upper, place, self.interpolate)

    def motion_at(self, row: int, time: float) -> Array:
        """State (3, 3) of an obstacle at a time [s]; after its last jerk it rests."""
        return self.motions[row].at(max(time - self.start, 0.0), self.step)

    def without(self, names: Collection[str]) -> Preview:
        """The preview of the rows that have none of these names."""
        return self.only([name not in names for name in self.rows])

    def only(self, kept: Collection[bool]) -> Preview:
        """The preview of some rows: `kept` (r,)."""
        chosen = np.array(tuple(kept), dtype=np.bool_)
        return replace(
            self,
            rows=tuple(compress(self.rows, kept)),
            lower=self.lower[chosen],
            upper=self.upper[chosen],
            active=tuple(compress(self.active, kept)),
            status=tuple(compress(self.status, kept)),
            conflict=tuple(compress(self.conflict, kept)),
            motions=tuple(compress(self.motions, kept)),
        )

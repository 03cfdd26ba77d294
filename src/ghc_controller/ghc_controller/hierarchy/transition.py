"""A continuous change from one priority matrix to another."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.priority_matrix import PriorityMatrix
from ghc_controller.numerics.minimum_jerk import minimum_jerk_share


class Profile(Enum):
    """How alpha moves from start to target over the normalized time s in [0, 1]."""

    COSINE = "cosine"  # eq. 15 of the GHC paper
    LINEAR = "linear"
    MINIMUM_JERK = "minimum_jerk"  # 10 s^3 - 15 s^4 + 6 s^5

    @classmethod
    def parse(cls, name: str) -> Profile:
        """Profile of that name; "" is the cosine of eq. 15."""
        try:
            return cls(name or "cosine")
        except ValueError:
            known = ", ".join(profile.value for profile in cls)
            raise InvalidValue(f"unknown profile '{name}'; known: {known}") from None

    def progress(self, s: float) -> float:
        """Progress at normalized time s, clipped to [0, 1]."""
        if s <= 0.0:
            return 0.0
        if s >= 1.0:
            return 1.0
        if self is Profile.COSINE:
            return 0.5 - 0.5 * math.cos(math.pi * s)
        if self is Profile.LINEAR:
            return s
        return minimum_jerk_share(s)


@dataclass(frozen=True, slots=True)
class Transition:
    """A requested ramp to `target`; it starts from the current mixture at `start`.

    With a `torque_rate` it takes as long as this budget requires, and at least `duration`.

    Raises:
        InvalidValue: a duration or torque rate that is negative or not finite.
    """

    target: PriorityMatrix
    start: float  # [s]
    duration: float  # [s]
    profile: Profile = Profile.COSINE
    id: str = ""
    hierarchy: str = ""  # the target as the user wrote it; empty when given as a matrix
    torque_rate: float = 0.0  # [Nm/s] that the ramp may add to any joint; 0 = no budget

    def __post_init__(self) -> None:
        if not math.isfinite(self.duration) or self.duration < 0.0:
            raise InvalidValue(
                f"duration = {self.duration} s given, a number of at least 0 expected"
            )
        if not math.isfinite(self.torque_rate) or self.torque_rate < 0.0:
            raise InvalidValue(
                f"torque_rate = {self.torque_rate} Nm/s given, a number of at least 0 expected"
            )
        if not math.isfinite(self.start):
            raise InvalidValue(f"start = {self.start} s given, a finite time expected")

    @property
    def end(self) -> float:
        """Earliest time at which the target is reached [s]."""
        return self.start + self.duration

    def progress(self, time: float) -> float:
        """Progress [-] that the duration allows at `time` (eq. 15)."""
        span, profile = time - self.start, self.profile
        if span >= self.duration:
            return 1.0
        share = span / self.duration
        if profile is Profile.MINIMUM_JERK and share > 0.0:  # as `Profile.progress`, in one call
            return minimum_jerk_share(share)
        return profile.progress(share)

"""Settings of the reachable references."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ghc_controller.errors import InvalidValue


@dataclass(frozen=True, slots=True)
class ReachableSettings:
    """How targets are checked, estimated, solved for and limited.

    Raises:
        InvalidValue: a number is not finite or out of range.
    """

    period: float = 0.01  # [s] T between two plans
    lead: float = 0.01  # [s] from a plan to its first point
    acceleration: float = 5.0  # [rad/s^2], [m/s^2] limit of every joint
    velocity_share: float = 0.8  # [-] of the robot's velocity limits
    position_margin: float = 0.02  # [rad], [m] kept from position limits; at most 5 % of a range
    smoothing: float = 0.12  # [s] window over which accelerations are averaged
    bandwidth: float = 12.0  # [1/s] of the filter that follows the estimated target
    jitter: float = 0.005  # [s] standard deviation of stamps
    noise: float = 2e-4  # [m], [rad] standard deviation of positions
    jump: float = 0.05  # [m], [rad] a sample farther from its prediction, ...
    speed: float = 1.0  # [m/s], [rad/s] ... plus this times the time between samples, is a jump
    largest_jump: float = 1.0  # [m], [rad] a sample beyond has to be confirmed by two more
    stale_after: float = 0.5  # [s] an older sample is rejected
    iterations: int = 4  # of the kinematic solver per plan
    trust_region: float = 0.02  # [rad], [m] per iteration
    restarts: int = 16  # other postures from which a target that is not met is tried

    def __post_init__(self) -> None:
        for field in ("period", "acceleration", "velocity_share", "smoothing", "bandwidth"):
            self._check(field, above_zero=True)
        for field in ("noise", "jump", "largest_jump", "stale_after", "trust_region"):
            self._check(field, above_zero=True)
        for field in ("lead", "position_margin", "jitter", "speed", "restarts"):
            self._check(field, above_zero=False)
        if self.iterations < 1:
            raise InvalidValue(f"iterations: {self.iterations} given, 1 or more expected")
        if self.velocity_share > 1.0:
            raise InvalidValue(f"velocity_share: {self.velocity_share} given, at most 1 expected")

    def _check(self, field: str, above_zero: bool) -> None:
        value = getattr(self, field)
        if not (math.isfinite(value) and (value > 0.0 or (value == 0.0 and not above_zero))):
            least = "> 0" if above_zero else ">= 0"
            raise InvalidValue(f"{field}: {value} given, a number {least} expected")

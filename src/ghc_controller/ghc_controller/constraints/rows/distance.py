"""One scalar that is kept in a range, or below a rate, as a row on joint accelerations."""

from __future__ import annotations

from abc import abstractmethod
from typing import NamedTuple

import numpy as np

from ghc_controller.constraints.constraint import (
    Constraint,
    Rows,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.core import (
    moving_approach,
    position_bound,
    velocity_bound,
    viable_acceleration,
)
from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array

APPROACH_RATE = 8.0  # [1/s] of the critically damped approach, as for joint positions
_NO_JERK = 1e-9  # [unit/s^3] below it the scalar cannot be moved at all


class Scalar(NamedTuple):
    """A scalar d(q) with d' = J v and d'' = J x + drift."""

    value: float  # d, in a unit such as m or rad
    rate: float  # [unit/s]
    jacobian: Array  # (n,) J
    drift: float  # [unit/s^2] dJ/dt v

    def rows(self, least: float, most: float, name: str) -> Rows:
        """The row least <= d'' <= most."""
        lower, upper = np.array([least - self.drift]), np.array([most - self.drift])
        return Rows(self.jacobian.reshape(1, -1), lower, upper, (name,))


class DistanceConstraint(Constraint):
    """Viability of one scalar: lower <= d <= upper, with d as `measure` says.

    The bounds on d'' are those of a joint position (`JointPositionLimit`): d can still stop before
    its bound with the deceleration `brake`, approaches it softly, and with a torque rate limit in
    force its acceleration can also fall there in time. It then changes with the jerk |J| j of all
    joints, j as in `PlannedJerk`, which they have together only while no other limit needs it.
    The row is soft.
    """

    space = Space.ACCELERATION
    softness = Softness.SOFT

    def __init__(
        self,
        name: str,
        lower: float,
        upper: float,
        brake: float,
        approach_rate: float = APPROACH_RATE,
    ) -> None:
        """Keep d between lower and upper, +-inf for no bound.

        Args:
            brake: [unit/s^2] deceleration that the torque limits must allow.
            approach_rate: [1/s].

        Raises:
            InvalidValue: bounds that leave nothing between them, or a number that is not positive.
        """
        super().__init__(name)
        if not lower < upper:
            raise InvalidValue(f"{name}: lower {lower:g}, upper {upper:g}: lower < upper expected")
        self.lower, self.upper = lower, upper
        self.brake = float(positive_per_joint(brake, 1, f"{name}, brake")[0])
        self.approach_rate = float(positive_per_joint(approach_rate, 1, f"{name}, rate")[0])

    @abstractmethod
    def measure(self, tick: Tick) -> Scalar:
        """The scalar at this state."""

    def rows(self, tick: Tick) -> Rows:
        """One row."""
        d = Scalar(*self.measure(tick))  # a plain tuple will do
        limits = (self.brake, self.approach_rate, tick.dt, jerk_along(tick, d.jacobian))
        most = most_acceleration(self.upper - d.value, d.rate, *limits)
        least = -most_acceleration(d.value - self.lower, -d.rate, *limits)
        if least > most:  # bounds too close for both: the one ahead counts
            least, most = (most, most) if d.rate > 0.0 else (least, least)
        return d.rows(least, most, self.name)


def rate_rows(d: Scalar, limit: float, horizon: float, tick: Tick, name: str) -> Rows:
    """The row that keeps d' below `limit` [unit/s], approached over `horizon` [s]."""
    margin = limit - d.rate
    most, jerk = margin / max(horizon, tick.dt), jerk_along(tick, d.jacobian)
    if margin > 0.0 and jerk > _NO_JERK:
        most = min(most, velocity_bound(margin, jerk, tick.dt))
    return d.rows(-np.inf, most, name)


def jerk_along(tick: Tick, jacobian: Array) -> float:
    """|J| j [unit/s^3], by which the joints can change J x; 0 without a torque rate limit."""
    if tick.jerk is None or tick.carried is None:
        return 0.0
    return float(np.abs(tick.carried @ jacobian) @ tick.jerk)


def most_acceleration(
    distance: float, speed: float, brake: float, rate: float, dt: float, jerk: float
) -> float:
    """Largest acceleration towards a bound at `distance`; jerk 0 = not limited."""
    most = min(
        viable_acceleration(distance, speed, brake, dt),
        moving_approach(distance, speed, 0.0, 0.0, brake, rate, dt),
    )
    return position_bound(distance, speed, jerk, brake, dt, most) if jerk > _NO_JERK else most

"""Least acceleration of a distance that has to stay above its margin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.constraints.constraint import Tick
from ghc_controller.constraints.rows.distance import APPROACH_RATE, most_acceleration
from ghc_controller.core import moving_approach
from ghc_controller.types import Array

HARDEST = 10.0  # [-] of `brake`, the most that a row asks for
_STOPPED = 1e-9  # [m] room that a stop may take, at the least
_NEAR = 1e-3  # [m] above the margin, over which the way back from below comes into force


class Margin(NamedTuple):
    """A margin at one instant."""

    value: float  # [m]
    rate: float  # [m/s]
    acceleration: float  # [m/s^2]


def least_acceleration(
    distance: float, rate: float, margin: Margin, brake: float, dt: float, jerk: float
) -> float:
    """Lower bound on d'' [m/s^2] at d = distance [m], d' = rate [m/s]; continuous in both.

    With the margin at rest, the law of `DistanceConstraint`: d can stop before it with `brake`
    [m/s^2], and reaches it softly. Two things differ. A distance that `brake` cannot stop any
    more, v^2 / (2 room) > brake, may brake harder, up to `HARDEST`: rows are soft, torques decide
    what is possible. And a distance below its margin is stopped as at the margin, and returns to
    it, critically damped, with `brake` at most; a joint beyond its limit merely goes no farther.
    A margin that moves is approached softly alone, x >= a + r^2 (m - d) - 2 r (v - w).
    """
    room, closing = distance - margin.value, -rate
    most = _most_towards(max(room, 0.0), closing, margin, brake, dt, jerk)
    soft = APPROACH_RATE * (APPROACH_RATE * room - 2.0 * (closing + margin.rate))
    back = max(soft - margin.acceleration, -brake)
    share = min(max(1.0 - room / _NEAR, 0.0), 1.0)
    return -(most + share * min(back - most, 0.0))


def _most_towards(
    room: float, closing: float, margin: Margin, brake: float, dt: float, jerk: float
) -> float:
    """Largest acceleration [m/s^2] towards a margin at room >= 0 [m]."""
    needed = closing * closing / (2.0 * max(room, _STOPPED)) if closing > 0.0 else 0.0
    late = needed > brake
    brake = min(max(brake, needed), HARDEST * brake)
    limits = (brake, APPROACH_RATE, dt)
    if margin.rate != 0.0 or margin.acceleration != 0.0:
        return moving_approach(room, closing, -margin.rate, -margin.acceleration, *limits)
    if late:  # as hard as that, but no harder than to a stop
        return -min(brake, closing / dt)
    return most_acceleration(room, closing, *limits, jerk)


def jerks_along(tick: Tick, jacobian: Array) -> Array:
    """(k,) |J| j [m/s^3], by which the joints can change J x; 0 without a torque rate limit."""
    if tick.jerk is None or tick.carried is None:
        return np.zeros(len(jacobian))
    return np.asarray(np.abs(jacobian @ tick.carried.T) @ tick.jerk)

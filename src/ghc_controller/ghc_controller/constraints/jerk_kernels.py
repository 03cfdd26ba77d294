"""Bounds on the acceleration of a joint whose acceleration changes with a bounded jerk.

A joint at distance d [rad] from a limit, approaching it with speed v [rad/s]; accelerations a
[rad/s^2] count towards the limit. From the next tick on the acceleration falls with the jerk -j
[rad/s^3] until it is -A, and stays there.
"""

from __future__ import annotations

import math

import numba

_LARGEST = 1e4  # [rad/s^2] search interval of a bound from above
_HALVINGS = 27  # of it, to 1e-4 rad/s^2
_TOLERANCE = 1e-5  # [rad] beyond a limit in which a joint may stop that periods made late


@numba.njit(cache=True)
def stopping_distance(v: float, a: float, jerk: float, brake: float) -> float:
    """Travel until the speed is 0 [rad]; 0 where the joint never moves towards the limit."""
    peak = a * a + 2.0 * jerk * v  # square of the acceleration at which v = 0, without -A
    if v <= 0.0 and (a <= 0.0 or peak <= 0.0):
        return 0.0
    if a <= -brake:
        return v * v / (2.0 * brake)
    T = (a + brake) / jerk
    rest = v + a * T - 0.5 * jerk * T * T  # speed when a reaches -A
    if rest <= 0.0:
        T = (a + math.sqrt(max(peak, 0.0))) / jerk
        rest = 0.0
    travel = v * T + 0.5 * a * T * T - jerk * T * T * T / 6.0
    return max(travel + rest * rest / (2.0 * brake), 0.0)


@numba.njit(cache=True)
def velocity_bound(margin: float, jerk: float, dt: float) -> float:
    """Largest a whose fall to 0 with -j gains no more than `margin` >= 0 [rad/s]."""
    delay = 1.5 * dt  # a acts for one period before it falls, in steps of j dt
    return jerk * (math.sqrt(delay * delay + 2.0 * margin / jerk) - delay)


@numba.njit(cache=True)
def position_bound(
    distance: float, v: float, jerk: float, brake: float, dt: float, cap: float
) -> float:
    """Largest a <= cap of this period after which the joint can still stop before its limit.

    Without one it brakes, by at most A, as a stop 1e-5 rad beyond the limit needs. Beyond that the
    way back keeps within what -j can stop.
    """
    if distance == math.inf:
        return cap
    if distance < 0.0 and v < 0.0:
        return min(cap, velocity_bound(-v, jerk, dt))
    if distance < max(v, 0.0) * dt:
        return min(cap, _stops_late(distance, v, brake, dt))
    if _can_stop(cap, distance, v, jerk, brake, dt):
        return cap
    low, high = -brake, min(cap, _LARGEST)
    if not _can_stop(low, distance, v, jerk, brake, dt):
        return min(cap, _stops_late(distance, v, brake, dt) if v > 0.0 else -brake)
    for _ in range(_HALVINGS):
        a = 0.5 * (low + high)
        if _can_stop(a, distance, v, jerk, brake, dt):
            low = a
        else:
            high = a
    return low


@numba.njit(cache=True)
def _stops_late(distance: float, v: float, brake: float, dt: float) -> float:
    """Deceleration of a joint that moves with v >= 0 and cannot stop in time."""
    most, room = max(-brake, -v / dt), distance + _TOLERANCE
    return max(most, -v * v / (2.0 * room)) if room > 0.0 else most


@numba.njit(cache=True)
def _can_stop(a: float, distance: float, v: float, jerk: float, brake: float, dt: float) -> bool:
    """Whether a joint that moves with a for one period can then stop within `distance`."""
    after = v + a * dt
    return after * dt + stopping_distance(after, a, jerk, brake) <= distance

"""A motion of the joints towards a goal within position, velocity and acceleration limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.reachable.settings import ReachableSettings
from ghc_controller.types import Array

_STEP = 1e-3  # [s] h
_BANDWIDTH = 30.0  # [1/s] w of both poles
_PROFILE = 0.6  # [-] of the acceleration limit that an approach plans with


@dataclass(frozen=True, slots=True)
class JointLimitsOfMotion:
    """Limits of a reference, (n,) each."""

    lower: Array  # [rad], [m]
    upper: Array
    velocity: Array  # [rad/s], [m/s] magnitude
    acceleration: Array  # [rad/s^2], [m/s^2] magnitude

    @classmethod
    def of(cls, model: RobotModel, settings: ReachableSettings) -> JointLimitsOfMotion:
        """Inside the limits of a robot with a fixed base."""
        ranges = model.position_upper - model.position_lower
        margin = np.minimum(settings.position_margin, 0.05 * ranges)
        return cls(
            model.position_lower + margin,
            model.position_upper - margin,
            settings.velocity_share * model.velocity_limit,
            np.full(model.nv, settings.acceleration),
        )

    def containing(self, q: Array) -> JointLimitsOfMotion:
        """The same with positions q (n,) inside."""
        lower, upper = np.minimum(self.lower, q), np.maximum(self.upper, q)
        return JointLimitsOfMotion(lower, upper, self.velocity, self.acceleration)


class JointMotion:
    """Accelerations held over steps of 1 ms, then averaged over a window.

    A weighted average of states within limits is within limits, and its acceleration has no step
    larger than a weight times twice the limit. The output is half a window late; goals are asked
    for that much ahead.

    Attributes:
        limits: in force.
        delay: [s] of the output.
    """

    def __init__(self, limits: JointLimitsOfMotion, window: float, q: Array) -> None:
        """At rest at q (n,)."""
        count = max(1, round(window / _STEP))
        weights = np.sin(np.pi * (np.arange(count) + 0.5) / count) ** 2  # Hann
        self._weights = weights / weights.sum()
        self.delay = 0.5 * (count - 1) * _STEP
        self.limits = limits.containing(q)
        self._rows = np.zeros((count, 3, len(q)))  # q, v, a, newest last
        self._rows[:, 0] = q

    def advance(self, goal: Array, rate: Array, steps: int) -> Array:
        """Move `steps` steps towards goals (n,) that move at `rate` (n,) and are reached then.

        Returns:
            (steps, 3, n) q, v, a of the output after each step.
        """
        rows = self._extended(self._rows, goal, rate, steps, False)
        self._rows = rows[-len(self._weights) :].copy()
        return self._averaged(rows)[1:]

    def tail(self, goal: Array, rate: Array, steps: int) -> Array:
        """What follows without a new goal: `steps` steps as before, then braking to rest.

        Returns:
            (s, 3, n) of the output as in `advance`; the last one is at rest.
        """
        rows = self._extended(self._rows, goal + steps * _STEP * rate, rate, steps, False)
        speed = np.abs(rows[-1, 1]) / self.limits.acceleration
        braking = int(speed.max() / _STEP) + 2 + len(self._weights)
        rows = self._extended(rows, goal, rate, braking, True)
        return self._averaged(rows)[1:]

    @property
    def output(self) -> Array:
        """(3, n) q, v, a now."""
        return np.tensordot(self._weights, self._rows, 1)

    def _extended(self, rows: Array, goal: Array, rate: Array, steps: int, brake: bool) -> Array:
        longer = np.zeros((len(rows) + steps, 3, rows.shape[2]))
        longer[: len(rows)] = rows
        limits = self.limits
        _move(
            longer,
            len(rows),
            goal,
            rate,
            limits.lower,
            limits.upper,
            limits.velocity,
            limits.acceleration,
            brake,
        )
        return longer

    def _averaged(self, rows: Array) -> Array:
        """(s, 3, n) of every window in rows (s + count - 1, 3, n)."""
        windows = np.lib.stride_tricks.sliding_window_view(rows, len(self._weights), axis=0)
        return np.asarray(windows @ self._weights)


@njit(cache=True)
def _move(
    rows: Array,
    first: int,
    goal: Array,
    rate: Array,
    lower: Array,
    upper: Array,
    velocity: Array,
    acceleration: Array,
    brake: bool,
) -> None:  # pragma: no cover
    """Fill rows (s, 3, n) from `first` on, each from the one before.

    v_d = rate + k_1 e, near the goal linear, else as braking with a share of the limit allows;
    a = k_2 (v_d - v). A velocity v' is allowed if braking from it ends before the position limit:
    q + v h / 2 + v' h + v'^2 / 2 A <= upper, which braking by A h per step preserves.
    """
    h, k1, k2 = _STEP, 0.5 * _BANDWIDTH, 2.0 * _BANDWIDTH
    count, n = rows.shape[0], rows.shape[2]
    for k in range(first, count):
        for i in range(n):
            q, v, A = rows[k - 1, 0, i], rows[k - 1, 1, i], acceleration[i]
            if brake:
                wanted = 0.0
                change = -v
            else:
                e = goal[i] - (count - 1 - k) * h * rate[i] - q - h * v
                planned = _PROFILE * A
                size = abs(e)
                if size < planned / k1**2:
                    speed = k1 * size
                else:
                    speed = np.sqrt(2.0 * planned * (size - 0.5 * planned / k1**2))
                wanted = rate[i] + (speed if e > 0.0 else -speed)
                wanted = min(max(wanted, -velocity[i]), velocity[i])
                change = k2 * h * (wanted - v)
            change = min(max(change, -A * h), A * h)
            after = v + change
            room = 2.0 * A * (upper[i] - q - 0.5 * v * h)
            most = np.sqrt(A * A * h * h + room) - A * h if room > 0.0 else -np.inf
            room = 2.0 * A * (q + 0.5 * v * h - lower[i])
            least = A * h - np.sqrt(A * A * h * h + room) if room > 0.0 else np.inf
            if after > most and after > 0.0:
                after = max(most, 0.0)
            if after < least and after < 0.0:
                after = min(least, 0.0)
            after = min(max(after, v - A * h), v + A * h)
            rows[k, 0, i] = q + 0.5 * h * (v + after)
            rows[k, 1, i] = after
            rows[k, 2, i] = (after - v) / h

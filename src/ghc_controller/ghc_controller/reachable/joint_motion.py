"""A motion of the joints towards a goal within position, velocity and acceleration limits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.core import native
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.reachable.settings import ReachableSettings
from ghc_controller.types import Array

_STEP = 1e-3  # [s] h, that of core/previews/motions.cpp


@dataclass(frozen=True, slots=True)
class JointLimitsOfMotion:
    """Limits of a reference, (n,) each."""

    lower: Array  # [rad], [m]
    upper: Array
    velocity: Array  # [rad/s], [m/s] magnitude
    acceleration: Array  # [rad/s^2], [m/s^2] magnitude
    jerk: Array  # [rad/s^3], [m/s^3] magnitude far from a goal

    @classmethod
    def of(cls, model: RobotModel, settings: ReachableSettings) -> JointLimitsOfMotion:
        """Inside the limits of the joints of a robot."""
        ranges = model.position_upper - model.position_lower
        margin = np.minimum(settings.position_margin, 0.05 * ranges)
        return cls(
            model.position_lower + margin,
            model.position_upper - margin,
            settings.velocity_share * model.velocity_limit,
            np.full(model.na, settings.acceleration),
            np.full(model.na, settings.jerk),
        )

    def containing(self, q: Array) -> JointLimitsOfMotion:
        """The same, widened to contain positions q (n,)."""
        lower, upper = np.minimum(self.lower, q), np.maximum(self.upper, q)
        return replace(self, lower=lower, upper=upper)


class JointMotion:
    """Accelerations held over steps of 1 ms, then averaged over a window.

    A weighted average of states within limits is within limits, and its acceleration has no step
    larger than a weight times twice the limit. The output is half a window late; goals are needed
    that much in advance.

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
        native.move_joints(
            longer,
            len(rows),
            goal,
            rate,
            limits.lower,
            limits.upper,
            limits.velocity,
            limits.acceleration,
            limits.jerk,
            brake,
        )
        return longer

    def _averaged(self, rows: Array) -> Array:
        """(s, 3, n) of every window in rows (s + count - 1, 3, n)."""
        windows = np.lib.stride_tricks.sliding_window_view(rows, len(self._weights), axis=0)
        return np.asarray(windows @ self._weights)

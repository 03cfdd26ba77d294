"""Position, velocity and acceleration of a target, estimated from samples at irregular times.

A Kalman filter with Singer's model (1970): the acceleration decays with a time constant and is
driven by white noise. All axes share one covariance (3, 3); rotations move by rotation vectors.
"""

from __future__ import annotations

import math

import numpy as np

from ghc_controller.numerics.minimum_jerk import minimum_jerk
from ghc_controller.reachable.settings import ReachableSettings
from ghc_controller.reachable.tangent import difference, moved
from ghc_controller.types import Array

_TIME_CONSTANT = 0.5  # [s] of accelerations
_ACCELERATION = 0.35  # [m/s^2], [rad/s^2] standard deviation
_FIRST_VELOCITY = 0.3  # [m/s], [rad/s] standard deviation before the second sample
_SILENCE = 0.3  # [s] of extrapolation at least, then the target returns to its last sample
_PERIODS = 5.0  # [-] of mean sample intervals, if that is longer
_RETURN = 0.5  # [s] that this takes


class MotionEstimator:
    """Motion of one target, a vector (m,) or a unit quaternion.

    Attributes:
        time: [s] of the last sample.
        sample: the last sample itself.
        interval: [s] mean time between samples, None before the second one.
    """

    def __init__(self, time: float, value: Array, rotation: bool, settings: ReachableSettings):
        self._settings, self._rotation = settings, rotation
        self.interval: float | None = None
        self.restart(time, value)

    def restart(self, time: float, value: Array) -> None:
        """At rest at a sample."""
        self.time, self.sample, self._position = time, value, value
        size = 3 if self._rotation else len(value)
        self._velocity, self._acceleration = np.zeros(size), np.zeros(size)
        self._P = np.diag([self._settings.noise, _FIRST_VELOCITY, _ACCELERATION]) ** 2

    def innovation(self, time: float, value: Array) -> Array:
        """(m,) from the prediction to a sample."""
        predicted, _, _ = self._propagated(time - self.time)
        return difference(value, predicted, self._rotation)

    def add(self, time: float, value: Array, jitter: float) -> None:
        """Take a sample later than the last one, its stamp with a deviation of `jitter` [s]."""
        dt = time - self.time
        self.interval = dt if self.interval is None else self.interval + 0.2 * (dt - self.interval)
        F, Q = _model(dt)
        predicted, velocity, acceleration = self._propagated(dt)
        self._P = F @ self._P @ F.T + Q
        error = difference(value, predicted, self._rotation)
        speed = float(np.linalg.norm(velocity))
        noise = self._settings.noise**2 + (speed * jitter) ** 2
        gain = self._P[:, 0] / (self._P[0, 0] + noise)
        self._P -= np.outer(gain, self._P[0])
        self._P = 0.5 * (self._P + self._P.T)
        self._position = moved(predicted, gain[0] * error, self._rotation)
        self._velocity = velocity + gain[1] * error
        self._acceleration = acceleration + gain[2] * error
        self.time, self.sample = time, value

    def at(self, time: float) -> tuple[Array, Array, Array]:
        """Target, its velocity and acceleration at a time [s].

        Without samples it returns to the last one.
        """
        dt = time - self.time
        silence = max(_SILENCE, _PERIODS * (self.interval or 0.0))
        position, velocity, acceleration = self._propagated(min(dt, silence))
        if dt <= silence:
            return position, velocity, acceleration
        way, rate, change = minimum_jerk((dt - silence) / _RETURN)
        away = difference(position, self.sample, self._rotation)
        back = moved(self.sample, (1.0 - way) * away, self._rotation)
        return back, -rate / _RETURN * away, -change / _RETURN**2 * away

    def _propagated(self, dt: float) -> tuple[Array, Array, Array]:
        F, _ = _model(dt)
        step = F[0, 1] * self._velocity + F[0, 2] * self._acceleration
        velocity = self._velocity + F[1, 2] * self._acceleration
        position = moved(self._position, step, self._rotation)
        return position, velocity, F[2, 2] * self._acceleration


def _model(dt: float) -> tuple[Array, Array]:
    """Transition (3, 3) and noise (3, 3) over dt [s], the noise to the order of dt / tau."""
    decay = 1.0 / _TIME_CONSTANT
    rest = math.exp(-decay * dt)
    F = np.array(
        [
            [1.0, dt, (decay * dt - 1.0 + rest) / decay**2],
            [0.0, 1.0, (1.0 - rest) / decay],
            [0.0, 0.0, rest],
        ]
    )
    density = 2.0 * decay * _ACCELERATION**2
    Q = density * np.array(
        [
            [dt**5 / 20.0, dt**4 / 8.0, dt**3 / 6.0],
            [dt**4 / 8.0, dt**3 / 3.0, dt**2 / 2.0],
            [dt**3 / 6.0, dt**2 / 2.0, dt],
        ]
    )
    return F, Q

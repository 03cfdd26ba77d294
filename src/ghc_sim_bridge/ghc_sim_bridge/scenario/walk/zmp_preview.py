"""Center-of-mass motion for a desired zero-moment point (ZMP) path, by preview control.

Kajita et al., Biped walking pattern generation by using preview control of zero-moment point
(ICRA 2003), as in section 5.4.4 of the thesis. One horizontal axis of a cart on a massless table,
state x = (position, velocity, acceleration) of the center of mass, input its jerk u:

    x+ = A x + B u,    p = C x = c - (z / g) d2c/dt2        (eq. 8 to 12)

The input minimizes sum_j Q e_j^2 + R (du_j)^2 with e = p - p_ref; the integral gain, state
feedback and N preview gains are computed once (eq. 14 to 17).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_discrete_are

from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array

GRAVITY = 9.81  # [m/s^2]


class CenterOfMassPath(NamedTuple):
    """Motion of the center of mass along one axis, at T samples."""

    position: Array  # (T,) [m]
    velocity: Array  # (T,) [m/s]
    acceleration: Array  # (T,) [m/s^2]
    zmp: Array  # (T,) [m] of the cart model


class ZmpPreview:
    """Preview controller for one height, step and horizon."""

    def __init__(
        self,
        height: float,
        step: float = 0.01,
        horizon: float = 1.6,
        error_weight: float = 1.0,
        jerk_weight: float = 1e-6,
    ) -> None:
        """Compute the gains.

        Args:
            height: of the center of mass above the ground, z [m].
            step: sample time [s].
            horizon: preview [s].
            error_weight: Q [1/m^2] of the zero-moment point's error.
            jerk_weight: R [s^6/m^2] of the change of the jerk.

        Raises:
            InvalidValue: a number is not positive.
        """
        given = (height, step, horizon, error_weight, jerk_weight)
        if not all(math.isfinite(value) and value > 0.0 for value in given):
            raise InvalidValue(f"height, step, horizon, weights {given} given, all > 0 expected")
        self.step = step
        self.size = max(1, round(horizon / step))  # samples of the preview
        self._transition = np.array([[1.0, step, step**2 / 2], [0.0, 1.0, step], [0.0, 0.0, 1.0]])
        self._input = np.array([step**3 / 6.0, step**2 / 2.0, step])
        self._output = np.array([1.0, 0.0, -height / GRAVITY])
        self._compute_gains(error_weight, jerk_weight)

    def _compute_gains(self, error_weight: float, jerk_weight: float) -> None:
        a, b, c = self._transition, self._input, self._output
        # State augmented by the ZMP error in front; the input is the change of the jerk.
        big_a = np.block([[np.ones((1, 1)), (c @ a)[None]], [np.zeros((3, 1)), a]])
        big_b = np.concatenate([[c @ b], b])[:, None]
        weight = np.zeros((4, 4))
        weight[0, 0] = error_weight
        p = solve_discrete_are(big_a, big_b, weight, np.array([[jerk_weight]]))
        scale = 1.0 / float(jerk_weight + (big_b.T @ p @ big_b)[0, 0])
        gains = scale * (big_b.T @ p @ big_a)[0]
        self._integral_gain, self._state_gain = float(gains[0]), gains[1:]
        closed = big_a - big_b @ gains[None]
        ahead = -closed.T @ p[:, 0]
        self._preview_gain = np.empty(self.size)
        self._preview_gain[0] = -self._integral_gain
        for k in range(1, self.size):
            self._preview_gain[k] = scale * float(big_b[:, 0] @ ahead)
            ahead = closed.T @ ahead
        # The reference is constant beyond the preview, so that a constant one is tracked exactly.
        self._preview_gain[-1] -= self._state_gain[0] + self._preview_gain.sum()

    def path(self, zmp: ArrayLike, start: ArrayLike = (0.0, 0.0, 0.0)) -> CenterOfMassPath:
        """Track a ZMP reference.

        Args:
            zmp: (T,) [m] at multiples of the step; its last value holds indefinitely. Changes
                within the horizon of the first sample are not anticipated in time.
            start: position [m], velocity [m/s], acceleration [m/s^2] at the first sample.

        Raises:
            InvalidValue: a sample is not finite, or there is none.
        """
        wanted = np.atleast_1d(np.asarray(zmp, dtype=float))
        if wanted.ndim != 1 or not len(wanted) or not np.isfinite(wanted).all():
            raise InvalidValue("a path of finite zero-moment points (T,) is expected")
        ahead = np.append(wanted, np.full(self.size, wanted[-1]))
        state = np.array(start, dtype=float)
        states, points = np.empty((len(wanted), 3)), np.empty(len(wanted))
        integral = 0.0
        for k in range(len(wanted)):
            states[k], points[k] = state, self._output @ state
            integral += points[k] - wanted[k]
            preview = self._preview_gain @ ahead[k + 1 : k + 1 + self.size]
            jerk = -self._integral_gain * integral - self._state_gain @ state - preview
            state = self._transition @ state + self._input * jerk
        return CenterOfMassPath(states[:, 0], states[:, 1], states[:, 2], points)

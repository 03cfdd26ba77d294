"""Torque limits and torque rate limit: the one gate of controller and bridge."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array

DEFAULT_TORQUE_RATE = 1000.0  # [Nm/s] where a robot's file gives none
COUNTED_EXCESS = 1e-6  # [Nm] a smaller excess is rounding of the QP: clipped, but not counted


class GatedTorque(NamedTuple):
    """A torque inside the limits, and which limits it had to be brought inside of."""

    torque: Array  # (n,) [Nm] fresh array
    limit_hit: bool
    rate_hit: bool


class TorqueGate:
    """Clips torques to `torque_limit` and their change per control period to rate * control_dt.

    The rate is clipped first: where both cannot hold, the torque limit wins.
    """

    def __init__(
        self, torque_limit: Array, torque_rate_limit: Array | float, control_dt: float
    ) -> None:
        """Set up the gate.

        Args:
            torque_limit: (n,) [Nm] > 0, inf where there is none.
            torque_rate_limit: [Nm/s], one number or (n,); 0 switches the rate check off.
            control_dt: [s] control period.

        Raises:
            InvalidValue: a limit that is not positive (the rate: negative or not finite).
        """
        if not (torque_limit > 0.0).all():
            raise InvalidValue(f"torque limit {torque_limit} given, positive numbers expected")
        rate = np.broadcast_to(np.asarray(torque_rate_limit, dtype=np.float64), torque_limit.shape)
        if not (np.isfinite(rate).all() and (rate >= 0.0).all()):
            raise InvalidValue(
                f"torque rate limit {torque_rate_limit} given, numbers >= 0 expected"
            )
        self.torque_limit = torque_limit.copy()
        # (n,) [Nm] per control period
        self.torque_step_limit: Array = np.where(rate > 0.0, rate * control_dt, np.inf)
        # The kernel is compiled for arrays like these; others, read-only ones too, are copied.
        self._wanted, self._previous = np.zeros(torque_limit.shape), np.zeros(torque_limit.shape)
        self(self._wanted, self._previous)  # loads the kernel before time runs

    def __call__(self, torque: Array, previous: Array) -> GatedTorque:
        """Torque to apply (n,) [Nm] after `previous` (n,) [Nm] was applied in the last period."""
        self._wanted[:] = torque
        self._previous[:] = previous
        gated = np.empty(self._wanted.shape)
        over_limit, over_rate, _ = clip_torque(
            self._wanted, self._previous, self.torque_limit, self.torque_step_limit, gated
        )
        return GatedTorque(gated, over_limit > COUNTED_EXCESS, over_rate > COUNTED_EXCESS)


@numba.njit(cache=True)
def clip_torque(
    torque: Array, previous: Array, limit: Array, step: Array, out: Array
) -> tuple[float, float, float]:
    """Clip to the rate, then to the limits; largest excess over limit, over rate, rate broken."""
    over_limit, over_rate, broken = 0.0, 0.0, 0.0
    for i in range(torque.shape[0]):
        value = torque[i]
        over_limit = max(over_limit, abs(value) - limit[i])
        over_rate = max(over_rate, abs(value - previous[i]) - step[i])
        value = min(max(value, previous[i] - step[i]), previous[i] + step[i])
        value = min(max(value, -limit[i]), limit[i])
        broken = max(broken, abs(value - previous[i]) - step[i])
        out[i] = value
    return over_limit, over_rate, broken

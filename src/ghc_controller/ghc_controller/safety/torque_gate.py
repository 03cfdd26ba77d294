"""Torque limits and torque rate limit: the gate used by controller and bridge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.core import Gate
from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array

DEFAULT_TORQUE_RATE = 1000.0  # [Nm/s] default if a robot's file gives none
COUNTED_EXCESS = 1e-6  # [Nm] a smaller excess is rounding of the QP: clipped, but not counted


class GatedTorque(NamedTuple):
    """A torque within the limits, and the limits that clipped it."""

    torque: Array  # (n,) [Nm] fresh array
    limit_hit: bool
    rate_hit: bool


class TorqueGate:
    """Clips torques to `torque_limit` and their change per control period to rate * control_dt.

    The rate is clipped first: if both cannot hold, the torque limit takes precedence.
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
        self.core = Gate(self.torque_limit, self.torque_step_limit)

    def __call__(self, torque: Array, previous: Array) -> GatedTorque:
        """Torque to apply (n,) [Nm] after `previous` (n,) [Nm] was applied in the last period."""
        gated = np.empty(self.torque_limit.shape)
        _, _, over_limit, over_rate, _ = self.core.clip(torque, previous, gated)
        return GatedTorque(gated, over_limit > COUNTED_EXCESS, over_rate > COUNTED_EXCESS)

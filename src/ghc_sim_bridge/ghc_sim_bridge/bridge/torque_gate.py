"""The last stage before the motors: torque limits and, when on, the torque rate limit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.types import Array

COUNTED_EXCESS = 1e-6  # [Nm] less is rounding of the controller's own bounds: clipped, not counted


class GatedTorque(NamedTuple):
    """A torque inside the limits, and which limits it had to be brought inside of."""

    torque: Array  # (n,) [Nm]
    limit_hit: bool
    rate_hit: bool


class TorqueGate:
    """Clips torques to `torque_limit` and their change per control period to rate * control_dt."""

    def __init__(self, torque_limit: Array, torque_rate_limit: float, control_dt: float) -> None:
        """Limits (n,) [Nm] (inf where there is none); rate [Nm/s], 0 = off; period [s]."""
        self.torque_limit = torque_limit
        self._lower_limit = -torque_limit
        self.torque_step_limit = (
            torque_rate_limit * control_dt if torque_rate_limit > 0.0 else np.inf
        )  # [Nm] per control period

    def __call__(self, torque: Array, previous: Array) -> GatedTorque:
        """Torque to apply (n,) [Nm] after `previous` (n,) [Nm] was applied in the last period.

        The rate is clipped first: where both cannot hold, the torque limit wins.
        """
        step = self.torque_step_limit
        gated = torque
        if step < np.inf:
            gated = np.minimum(np.maximum(gated, previous - step), previous + step)
        gated = np.minimum(np.maximum(gated, self._lower_limit), self.torque_limit)
        if (gated == torque).all():
            return GatedTorque(gated, False, False)
        return GatedTorque(
            gated,
            limit_hit=bool((np.abs(torque) > self.torque_limit + COUNTED_EXCESS).any()),
            rate_hit=bool((np.abs(torque - previous) > step + COUNTED_EXCESS).any()),
        )

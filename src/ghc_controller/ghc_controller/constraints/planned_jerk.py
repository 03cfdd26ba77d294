"""The jerk with which position and velocity limits plan, from the torque rate limit."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ghc_controller.constraints.constraint import positive_per_joint
from ghc_controller.constraints.jerk_share import base_follows, share_rate
from ghc_controller.types import Array, Dynamics, RobotState

_MEMORY = 0.05  # [s] time constant with which a measured drift fades
_LONGEST = 1.5  # [-] control periods between two states that are compared
_NO_CONTACTS = np.zeros((0, 0))


class _Seen(NamedTuple):
    """The state before."""

    time: float  # [s]
    velocity: Array  # (n,)
    dynamics: Dynamics


class PlannedJerk:
    """j_k = kappa r_k / T_kk [rad/s^3]: what every joint can change its acceleration by at once.

    Torques T dx/dt = dtau/dt - delta within the rate r for any signs of all jerks: |T| j <=
    r - |delta|. T is the inertia of the joints with the base following them (`jerk_share`), delta
    [Nm/s] the drift of the torque at constant acceleration, G (dM/dt x + dh/dt), measured between
    the last two states and held with a memory of 50 ms. Derivation: docs/limits.md.

    Attributes:
        share: kappa of the last update.
        jerk: (a,) [rad/s^3] of the last update, which the next one overwrites.
        drift: (a,) [Nm/s] magnitude of delta in force.
        carried: (a, n) G of the last update.
    """

    def __init__(self, rate: Array | float, joints: int) -> None:
        """Take the rate limit r [Nm/s], one number or (a,)."""
        self.rate = positive_per_joint(rate, joints, "torque_rate")
        self.share = 0.0
        self.jerk, self.drift = np.empty(joints), np.zeros(joints)
        self.carried = np.zeros((joints, joints))
        self._seen: _Seen | None = None

    def reset(self) -> None:
        """Forget the last state and its drift."""
        self._seen = None
        self.drift[:] = 0.0

    def update(
        self, dynamics: Dynamics, state: RobotState, contacts: Array | None, dt: float
    ) -> Array:
        """Jerk (a,) at a state.

        Args:
            contacts: (q, n) motion rows of the contacts that are on; None without.
            dt: [s] control period.
        """
        rows = _NO_CONTACTS if contacts is None else np.ascontiguousarray(contacts)
        carried = self.carried = base_follows(dynamics.mass_matrix, rows, len(self.rate))
        self._measure(carried, dynamics, state, dt)
        self.share = share_rate(dynamics.mass_matrix, carried, self.drift, self.rate, self.jerk)
        return self.jerk

    def _measure(self, carried: Array, dynamics: Dynamics, state: RobotState, dt: float) -> None:
        seen, self._seen = self._seen, _Seen(state.time, state.v.copy(), dynamics)
        self.drift *= math.exp(-dt / _MEMORY)
        if seen is None or not 0.0 < state.time - seen.time < _LONGEST * dt:
            return
        before, period = seen.dynamics, state.time - seen.time
        acceleration = (state.v - seen.velocity) / period
        change = (dynamics.mass_matrix - before.mass_matrix) @ acceleration
        change += dynamics.bias - before.bias
        drift = np.abs(carried @ change) / period
        if np.isfinite(drift).all():
            np.maximum(self.drift, drift, out=self.drift)

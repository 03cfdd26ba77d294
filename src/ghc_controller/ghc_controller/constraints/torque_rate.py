"""Largest change of torque per control period."""

from __future__ import annotations

import numpy as np

from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.constraints.torque_limit import box_around
from ghc_controller.types import Array


class TorqueRateLimit(BoxConstraint):
    """previous -+ rate dt per actuated joint, around the torque that was applied last.

    Gives way after position and velocity limits and before torque limits. Without a previous
    torque (before the first period) it bounds nothing.
    """

    space = Space.TORQUE
    softness = Softness.RATE

    def __init__(self, rate: Array | float, joints: int, name: str = "torque_rate") -> None:
        """Rate [Nm/s], one number or (a,); leave the constraint out to switch it off."""
        super().__init__(name)
        self.rate = positive_per_joint(rate, joints, name)
        self._step = np.zeros(joints)  # [Nm] rate dt of the period used last
        self._dt = 0.0

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the torque box around `previous_torque`."""
        if tick.previous_torque is None:
            lower.fill(-np.inf)
            upper.fill(np.inf)
            return
        if tick.dt != self._dt:
            self._step, self._dt = self.rate * tick.dt, tick.dt
        box_around(tick.previous_torque, self._step, lower, upper)

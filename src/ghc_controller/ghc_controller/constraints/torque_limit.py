"""Torque limits of the actuators, or lower bounds chosen for an experiment."""

from __future__ import annotations

from enum import Enum

import numba
import numpy as np

from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.types import Array


class TorqueCenter(Enum):
    """What a torque bound is symmetric about."""

    ZERO = "zero"  # |tau| <= limit: what an actuator can deliver
    GRAVITY = "gravity"  # |tau - g(q)| <= limit: what is left beside carrying the arm


class TorqueLimit(BoxConstraint):
    """center - limit <= tau <= center + limit per actuated joint [Nm]; never gives way."""

    space = Space.TORQUE
    softness = Softness.HARD

    def __init__(
        self,
        limit: Array | float,
        joints: int,
        around: TorqueCenter = TorqueCenter.ZERO,
        name: str = "torque_limit",
    ) -> None:
        """Limit [Nm], one number or (a,)."""
        super().__init__(name)
        self.limit = positive_per_joint(limit, joints, name)
        self.around = around
        self._zero = np.zeros(joints)

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the torque box of this state."""
        center = tick.model.gravity() if self.around is TorqueCenter.GRAVITY else self._zero
        box_around(center, self.limit, lower, upper)


@numba.njit(cache=True)
def box_around(center: Array, half_width: Array, lower: Array, upper: Array) -> None:
    """Write center -+ half_width (a,); of `center` only the last a entries count."""
    base = center.shape[0] - half_width.shape[0]
    for i in range(half_width.shape[0]):
        lower[i] = center[base + i] - half_width[i]
        upper[i] = center[base + i] + half_width[i]

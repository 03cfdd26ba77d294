"""Torque limits of the actuators, or lower bounds chosen for an experiment."""

from __future__ import annotations

from collections.abc import Sequence
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
from ghc_controller.errors import UnknownName
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.previews.preview import TORQUE_LIMITS, Preview
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
        follows: Sequence[str] = (),
    ) -> None:
        """Limit [Nm], one number or (a,).

        `follows` names the joints where previews may tighten it; empty = none may.
        """
        super().__init__(name)
        self.limit = positive_per_joint(limit, joints, name)
        self.around = around
        self._zero = np.zeros(joints)
        self.limits: LimitsInForce | None = None
        if follows:
            self.kind = TORQUE_LIMITS
            self.limits = LimitsInForce(TORQUE_LIMITS, follows, -self.limit, self.limit)

    def follow(self, preview: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """See `LimitsInForce.follow`; InvalidValue where none is followed."""
        return super().follow(preview) if self.limits is None else self.limits.follow(preview, now)

    def is_stale(self, time: float) -> bool:
        """Whether the preview has ended at `time` [s]."""
        return self.limits is not None and self.limits.is_stale(time)

    def reset(self) -> None:
        """Forget the preview."""
        if self.limits is not None:
            self.limits.reset()

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the torque box of this state."""
        if self.limits is not None and self.limits.planned:
            limits = self.limits.at(tick.state.time)
            lower[:], upper[:] = limits.lower, limits.upper
            return
        center = tick.model.gravity() if self.around is TorqueCenter.GRAVITY else self._zero
        box_around(center, self.limit, lower, upper)


@numba.njit(cache=True)
def box_around(center: Array, half_width: Array, lower: Array, upper: Array) -> None:
    """Write center -+ half_width (a,); of `center` only the last a entries count."""
    base = center.shape[0] - half_width.shape[0]
    for i in range(half_width.shape[0]):
        lower[i] = center[base + i] - half_width[i]
        upper[i] = center[base + i] + half_width[i]

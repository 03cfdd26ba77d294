"""Torque limits of the actuators, or lower bounds chosen for an experiment."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

import numpy as np

from ghc_controller.constraints.compiled import CompiledBox
from ghc_controller.constraints.constraint import Softness, Space, positive_per_joint
from ghc_controller.core import TorqueBox
from ghc_controller.errors import UnknownName
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.previews.preview import TORQUE_LIMITS, Preview
from ghc_controller.types import Array

_NO_RANGE = np.zeros(0)


class TorqueCenter(Enum):
    """What a torque bound is symmetric about."""

    ZERO = "zero"  # |tau| <= limit: what an actuator can deliver
    GRAVITY = "gravity"  # |tau - g(q)| <= limit: what is left beside carrying the arm


class TorqueLimit(CompiledBox):
    """center - limit <= tau <= center + limit per actuated joint [Nm]; never relaxed."""

    space = Space.TORQUE
    softness = Softness.HARD
    core: TorqueBox

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
        self.core = TorqueBox(self.limit, around is TorqueCenter.GRAVITY)
        self._planned = False  # whether the core has a range of a preview
        self.limits: LimitsInForce | None = None
        if follows:
            self.kind = TORQUE_LIMITS
            self.changes = True
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

    def range_at(self, time: float, gravity: Array) -> tuple[Array, Array]:
        """Lower and upper (a,) [Nm] at a time [s] and gravity torques (a,) [Nm]."""
        if self.limits is not None and self.limits.planned:
            limits = self.limits.at(time)
            return limits.lower, limits.upper
        if self.around is TorqueCenter.GRAVITY:
            return gravity - self.limit, gravity + self.limit
        return -self.limit, self.limit

    def prepare(self, time: float) -> None:
        """See CompiledBox."""
        if self.limits is not None and self.limits.planned:
            limits = self.limits.at(time)
            self.core.set_range(limits.lower, limits.upper)
            self._planned = True
        elif self._planned:
            self.core.set_range(_NO_RANGE, _NO_RANGE)
            self._planned = False

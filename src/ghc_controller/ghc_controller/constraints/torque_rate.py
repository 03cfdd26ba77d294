"""Largest change of torque per control period."""

from __future__ import annotations

from ghc_controller.constraints.compiled import CompiledBox
from ghc_controller.constraints.constraint import Softness, Space, positive_per_joint
from ghc_controller.core import RateBox
from ghc_controller.types import Array


class TorqueRateLimit(CompiledBox):
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
        self.core = RateBox(self.rate)

    def set_rate(self, rate: Array) -> None:
        """Change the rate [Nm/s] to (a,) positive numbers; it counts from the next state on."""
        self.rate[:] = rate  # the core reads it where it is

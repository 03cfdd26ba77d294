"""Joint velocity limits, acting over a horizon."""

from __future__ import annotations

from ghc_controller.constraints.compiled import CompiledBox
from ghc_controller.constraints.constraint import Softness, Space, positive_per_joint
from ghc_controller.core import VelocityBox
from ghc_controller.types import Array


class JointVelocityLimit(CompiledBox):
    """(-limit - v) / h <= dv <= (limit - v) / h per joint.

    Approaching the limit no faster than exponentially with time constant h [s] costs less torque
    rate than stopping within one period; h of 10 to 50 ms is advised, and h below the control
    period is raised to it. Above the limit the box demands braking back to it. With a planned jerk
    (`Tick.jerk`) the acceleration must also be able to fall to 0 before the limit.
    """

    space = Space.ACCELERATION
    softness = Softness.SOFT
    core: VelocityBox

    def __init__(
        self,
        limit: Array | float,
        joints: int,
        horizon: float,
        name: str = "velocity_limit",
    ) -> None:
        """Bound the last `joints` entries of v by limit [rad/s], one number or (a,)."""
        super().__init__(name)
        self.limit = positive_per_joint(limit, joints, name)
        span = float(positive_per_joint(horizon, 1, f"{name}, horizon")[0])
        self.core = VelocityBox(self.limit, span)

    @property
    def horizon(self) -> float:
        """[s]."""
        return self.core.horizon

    @horizon.setter
    def horizon(self, horizon: float) -> None:
        self.core.horizon = horizon

"""Joint velocity limits, acting over a horizon."""

from __future__ import annotations

import numba

from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.constraints.jerk_kernels import velocity_bound
from ghc_controller.types import Array


class JointVelocityLimit(BoxConstraint):
    """(-limit - v) / h <= dv <= (limit - v) / h per joint.

    Approaching the limit no faster than exponentially with time constant h [s] costs less torque
    rate than stopping within one period; h of 10 to 50 ms is advised, and h below the control
    period is raised to it. Above the limit the box demands braking back to it. With a planned jerk
    (`Tick.jerk`) the acceleration must also be able to fall to 0 before the limit.
    """

    space = Space.ACCELERATION
    softness = Softness.SOFT

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
        self.horizon = float(positive_per_joint(horizon, 1, f"{name}, horizon")[0])

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:
        """Write the acceleration box of this state."""
        _velocity_box(tick.model.v, self.limit, max(self.horizon, tick.dt), lower, upper)
        if tick.jerk is not None:
            _narrow(tick.model.v, self.limit, tick.jerk, tick.dt, lower, upper)


@numba.njit(cache=True)
def _velocity_box(v: Array, limit: Array, horizon: float, lower: Array, upper: Array) -> None:
    base = v.shape[0] - limit.shape[0]
    for i in range(limit.shape[0]):
        lower[base + i] = (-limit[i] - v[base + i]) / horizon
        upper[base + i] = (limit[i] - v[base + i]) / horizon


@numba.njit(cache=True)
def _narrow(v: Array, limit: Array, jerk: Array, dt: float, lower: Array, upper: Array) -> None:
    """Narrow a box to accelerations that can fall to 0 before the limit; (a,) jerk."""
    base = v.shape[0] - limit.shape[0]
    for i in range(limit.shape[0]):
        to_upper, to_lower = limit[i] - v[base + i], limit[i] + v[base + i]
        if to_upper > 0.0:
            upper[base + i] = min(upper[base + i], velocity_bound(to_upper, jerk[i], dt))
        if to_lower > 0.0:
            lower[base + i] = max(lower[base + i], -velocity_bound(to_lower, jerk[i], dt))

"""Virtual motion of one obstacle: a chain of integrators and the jerk of every step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.core import native
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class PlannedMotion:
    """Virtual motion of one obstacle: a state now, and the jerk of every step."""

    id: str
    frame: str  # protected frame of the robot
    safe_distance: float  # [m]
    normal: Array  # (3,) unit, from the obstacle to the protected frame, world axes
    state: Array  # (3, 3) row = position [m], velocity [m/s], acceleration [m/s^2]; world axes
    jerk: Array  # (N, 3) [m/s^3]; (0, 3) = no motion
    status: PreviewStatus

    @property
    def moves(self) -> bool:
        """True when its state is a virtual one, to be continued by the next plan."""
        return len(self.jerk) > 0 or self.status is PreviewStatus.TIGHTENED

    def trajectory(self, step: float) -> Array:
        """States (N + 1, 3, 3) at the points of the plan."""
        return native.integrate(self.state, self.jerk, step)

    def at(self, elapsed: float, step: float) -> Array:
        """State (3, 3) `elapsed` [s] after the start; after the plan it rests where that ends.

        Without a jerk it stands still: a velocity or acceleration of `state` does not count, since
        no position would follow it.
        """
        if not len(self.jerk):
            if not self.state[1:].any():
                return self.state
            still = np.zeros_like(self.state)
            still[0] = self.state[0]
            return still
        return native.state_at(self.state, self.jerk, step, elapsed)

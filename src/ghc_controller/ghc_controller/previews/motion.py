"""Virtual motion of one obstacle: a chain of integrators and the jerk of every step."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

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
    jerk: Array  # (N, 3) [m/s^3]; (0, 3) = stands still
    status: PreviewStatus

    @property
    def moves(self) -> bool:
        """True when its state is a virtual one, to be continued by the next plan."""
        return len(self.jerk) > 0 or self.status is PreviewStatus.TIGHTENED

    def trajectory(self, step: float) -> Array:
        """States (N + 1, 3, 3) at the points of the plan."""
        return integrate(self.state, self.jerk, step)

    def at(self, elapsed: float, step: float) -> Array:
        """State (3, 3) `elapsed` [s] after the start; after the plan it rests where that ends."""
        return state_at(self.state, self.jerk, step, elapsed) if len(self.jerk) else self.state


@numba.njit(cache=True)
def integrate(state: Array, jerk: Array, step: float) -> Array:  # pragma: no cover
    """States (N + 1, 3, 3) of three triple integrators under jerks (N, 3) held over steps."""
    states = np.empty((jerk.shape[0] + 1, 3, 3))
    states[0] = state
    for j in range(jerk.shape[0]):
        states[j + 1] = states[j]
        _advance(states[j + 1], jerk[j], step)
    return states


@numba.njit(cache=True)
def state_at(state: Array, jerk: Array, step: float, elapsed: float) -> Array:  # pragma: no cover
    """State (3, 3) `elapsed` [s] after the first one; after the last step it rests."""
    present = state.copy()
    whole = int(elapsed / step + 1e-6)
    for j in range(min(whole, jerk.shape[0])):
        _advance(present, jerk[j], step)
    if whole < jerk.shape[0]:
        _advance(present, jerk[whole], max(elapsed - whole * step, 0.0))
    else:
        present[1:] = 0.0
    return present


@numba.njit(cache=True)
def _advance(state: Array, jerk: Array, step: float) -> None:  # pragma: no cover
    """Move a state (3, 3) on by `step` [s] under a jerk (3,)."""
    for axis in range(3):
        v, a, u = state[1, axis], state[2, axis], jerk[axis]
        state[0, axis] += step * (v + step * (a / 2.0 + step * u / 6.0))
        state[1, axis] += step * (a + step * u / 2.0)
        state[2, axis] += step * u

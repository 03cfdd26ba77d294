"""One run of section 4.4: an obstacle enters the safe distance at 3 s and leaves it at 7 s."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ghc_controller.types import Array
from ghc_mpc_constraints.previews.horizon import Horizon, integrator_chain
from ghc_mpc_constraints.previews.motion_qp import MotionQp
from ghc_mpc_constraints.previews.motion_weights import POWER, dynamic_weights

SAFE, VIOLATION, MAX_VELOCITY = 0.4, 0.2, 0.1  # [m] d_s, [m] d_v, [m/s]
ENTERS, LEAVES, END = 3.0, 7.0, 9.0  # [s]
DUE = ENTERS + VIOLATION / MAX_VELOCITY  # [s] eq. 4.4


@dataclass(frozen=True, slots=True)
class MotionCase:
    """Parameters of the study; the defaults are those of figure 4.5, with D for figure 4.8."""

    jerk_weight: float = 1e-5  # [s^6] gamma
    horizon: float = 1.5  # [s]
    dynamic: bool = False
    power: float = POWER  # [-] g
    outside: float = SAFE  # [m] position of the obstacle before and after
    step: float = 0.01  # [s]


@dataclass(frozen=True, slots=True)
class MotionRun:
    """Result of a run."""

    case: MotionCase
    time: Array  # (k,) [s]
    raw: Array  # (k,) [m] reference, the reaction time included
    state: Array  # (k, 3) position, velocity, acceleration

    @property
    def overshoot(self) -> float:
        """Overshoot of the closest position [%] of the steady state."""
        inside = SAFE - VIOLATION
        due = (self.time > DUE - 0.5) & (self.time < LEAVES)
        return 100.0 * (inside - float(self.state[due, 0].min())) / inside


def reference(case: MotionCase, now: float, times: Array) -> Array:
    """Preview at `now`: entering takes effect after the reaction time, leaving at once."""
    entered = ENTERS - 1e-9 <= now < LEAVES - 1e-9
    inside = entered & (times >= DUE - 1e-9)
    return np.where(inside, SAFE - VIOLATION, case.outside)


def run_motion(case: MotionCase) -> MotionRun:
    """Run the QP of one axis over the motion (eq. 4.14, or 4.15 with D)."""
    horizon = Horizon.of(case.step, case.horizon)
    qp = MotionQp(horizon, case.jerk_weight)

    def solve(state: Array, raw: Array) -> float:
        weights = dynamic_weights(raw, case.power) if case.dynamic else np.ones_like(raw)
        jerk = qp.solve(state, raw, weights, raw)
        assert jerk is not None
        return float(jerk[0])

    return roll(case, horizon, solve, 3)


def roll(
    case: MotionCase, horizon: Horizon, solve: Callable[[Array, Array], float], order: int
) -> MotionRun:
    """Apply the first input of `solve(state, preview)` to a chain of `order` integrators."""
    model = integrator_chain(order, horizon)
    state = np.zeros(order)
    state[0] = case.outside
    time = case.step * np.arange(round(END / case.step), dtype=np.float64)
    states = np.empty((len(time), order))
    for k, now in enumerate(time):
        states[k] = state
        raw = reference(case, now, horizon.times(now)[1:])
        if np.ptp(raw) > 0.0 or np.abs(state - [raw[0], *[0.0] * (order - 1)]).max() > 1e-12:
            state = model.transition @ state + model.input_gain * solve(state, raw)
    raw = np.array([reference(case, now, np.array([now]))[0] for now in time])
    return MotionRun(case, time, raw, states)

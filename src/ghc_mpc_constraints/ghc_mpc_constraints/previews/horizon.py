"""Chains of integrators and their stacked responses over a horizon of N steps of T.

    x(k+1) = A x(k) + B u(k)                        u constant over a step
    X = state_response x(k) + input_response U      position part only (eq. 4.13)

The responses depend only on T and N: they are computed once and shared by all ticks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import PLAN_STEP, POSITIVE
from ghc_controller.types import PREVIEW_STEP, Array

STEP_TOLERANCE = 1e-6  # [-] distance of a time from the grid, as a fraction of a step

# Common settings of all generators.
STEP = declared(
    "T between ticks; a multiple of the control period", PREVIEW_STEP, unit="s", domain=PLAN_STEP
)
HORIZON = declared("N T of the preview; a multiple of the step", 1.5, unit="s", domain=POSITIVE)
SMOOTHING = declared("false: raw values pass through, for comparison", True)


@dataclass(frozen=True, slots=True)
class Horizon:
    """The grid of a preview: the start, and `steps` further points `step` [s] apart."""

    step: float  # [s] T
    steps: int  # [-] N

    @classmethod
    def of(cls, step: float, duration: float) -> Horizon:
        """Horizon of a duration N T [s].

        Raises:
            InvalidValue: not positive and finite, or the duration is not a multiple of the step.
        """
        for name, value in (("step", step), ("horizon", duration)):
            if not (math.isfinite(value) and value > 0.0):
                raise InvalidValue(f"{name} = {value} s given, a finite number above 0 expected")
        steps = round(duration / step)
        if steps < 2 or abs(steps * step - duration) > STEP_TOLERANCE * step:
            raise InvalidValue(
                f"horizon = {duration:g} s given, a multiple of the step ({step:g} s) and at "
                "least two of them expected"
            )
        return cls(step, steps)

    @property
    def duration(self) -> float:
        """N T [s]."""
        return self.step * self.steps

    def times(self, start: float) -> Array:
        """Times [s] of the N + 1 points, `start` included."""
        return start + self.step * np.arange(self.steps + 1, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class PreviewModel:
    """A chain of `order` integrators: 1 = rate in (eq. 5.6), 3 = jerk in (eq. 4.11)."""

    transition: Array  # (order, order) A
    input_gain: Array  # (order,) B
    state_response: Array  # (N, order) positions that follow from the state, A-hat_x
    input_response: Array  # (N, N) lower triangular, positions per unit of input, B-hat_x


@lru_cache(maxsize=16)
def integrator_chain(order: int, horizon: Horizon) -> PreviewModel:
    """Exact discretization of `order` integrators, input held over a step, and its responses."""
    step, steps = horizon.step, horizon.steps
    powers = [step**i / math.factorial(i) for i in range(order + 1)]
    transition = np.array(
        [[powers[j - i] if j >= i else 0.0 for j in range(order)] for i in range(order)]
    )
    input_gain = np.array([powers[order - i] for i in range(order)])
    state_response = np.empty((steps, order))
    impulse = np.empty(steps)  # position i + 1 steps after a unit input
    row, state = np.eye(order)[0], input_gain
    for i in range(steps):
        row = row @ transition
        state_response[i] = row
        impulse[i] = state[0]
        state = transition @ state
    lag = np.subtract.outer(np.arange(steps), np.arange(steps))
    input_response = np.where(lag >= 0, impulse[lag], 0.0)
    arrays = (transition, input_gain, state_response, input_response)
    for array in arrays:
        array.setflags(write=False)
    return PreviewModel(*arrays)

"""Integrator chains: the stacked responses are the recursion."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import InvalidValue
from ghc_mpc_constraints.previews.horizon import Horizon, integrator_chain


@pytest.mark.parametrize("order", [1, 2, 3])
def test_stacked_responses_equal_the_recursion(order: int) -> None:
    """Positions from the stacked matrices (eq. 4.13) and step by step (eq. 4.11) agree."""
    rng = np.random.default_rng(order)
    horizon = Horizon.of(0.02, 0.8)
    model = integrator_chain(order, horizon)
    start, inputs = rng.normal(size=order), rng.normal(size=horizon.steps)
    state, positions = start, []
    for value in inputs:
        state = model.transition @ state + model.input_gain * value
        positions.append(state[0])
    stacked = model.state_response @ start + model.input_response @ inputs
    assert np.allclose(stacked, positions, rtol=0.0, atol=1e-13)


def test_triple_integrator_is_the_thesis_one() -> None:
    model = integrator_chain(3, Horizon.of(0.1, 1.0))
    assert np.allclose(model.transition, [[1, 0.1, 0.005], [0, 1, 0.1], [0, 0, 1]])
    assert np.allclose(model.input_gain, [0.001 / 6, 0.005, 0.1])


def test_responses_are_made_once_and_cannot_be_changed() -> None:
    horizon = Horizon.of(0.01, 0.5)
    model = integrator_chain(3, horizon)
    assert integrator_chain(3, Horizon.of(0.01, 0.5)) is model
    with pytest.raises(ValueError, match="read-only"):
        model.input_response[0, 0] = 1.0


@pytest.mark.parametrize(
    ("step", "duration", "words"),
    [
        (0.01, 0.015, "multiple of the step"),
        (0.01, 0.01, "at least two"),
        (0.0, 1.0, "step = 0.0 s given"),
        (0.01, float("nan"), "horizon = nan s given"),
    ],
)
def test_bad_horizons_are_refused(step: float, duration: float, words: str) -> None:
    with pytest.raises(InvalidValue, match=words):
        Horizon.of(step, duration)

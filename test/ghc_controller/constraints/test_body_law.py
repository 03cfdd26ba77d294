"""The law of one distance: no jump anywhere, bounded, and a body that stops or returns."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ghc_controller.constraints.bodies.law import HARDEST, Margin, least_acceleration
from ghc_controller.types import Array

BRAKE, DT = 5.0, 1e-3  # [m/s^2], [s]
REST = Margin(0.02, 0.0, 0.0)
RISES = Margin(0.02, 0.15, 0.4)


def _jump(law: Callable[[Array], float], start: Array, end: Array) -> float:
    """Largest jump [m/s^2] on the way between two states: its ends are moved together."""
    places = np.linspace(0.0, 1.0, 200)
    values = [law(start + s * (end - start)) for s in places.tolist()]
    at = int(np.argmax(np.abs(np.diff(values))))
    low, high = places[at], places[at + 1]
    below, above = values[at], values[at + 1]
    for _ in range(40):
        middle = 0.5 * (low + high)
        value = law(start + middle * (end - start))
        if abs(value - below) > abs(above - value):
            high, above = middle, value
        else:
            low, below = middle, value
    return abs(above - below)


@pytest.mark.parametrize("margin", [REST, RISES])
@pytest.mark.parametrize("jerk", [0.0, 40.0, 400.0])
def test_the_law_is_continuous_in_distance_and_speed(margin: Margin, jerk: float) -> None:
    """Across the margin and anywhere else, at scales from a micrometer to centimeters.

    With a jerk limit the law of joint positions itself steps within one period of the margin, at
    less than 1 cm/s.
    """
    rng = np.random.default_rng(8)

    def law(state: Array) -> float:
        return least_acceleration(state[0], state[1], margin, BRAKE, DT, jerk)

    worst = 0.0
    for _ in range(150):
        spread = 10.0 ** rng.uniform(-6.0, -1.5, 2), 10.0 ** rng.uniform(-4.0, 0.0, 2)
        states = np.transpose(spread) * rng.uniform(-1.0, 1.0, (2, 2)) + [margin.value, 0.0]
        worst = max(worst, _jump(law, *states))
    assert worst < (0.1 * BRAKE if jerk and margin is REST else 1e-3)
    assert law(np.array([margin.value - 1e-9, -0.3])) == pytest.approx(
        law(np.array([margin.value + 1e-9, -0.3])), abs=1e-3
    )


def test_a_row_never_asks_for_more_than_its_bound() -> None:
    """Nor, where the margin rests and the distance is above it, for more than a stop."""
    rng = np.random.default_rng(9)
    for _ in range(3000):
        room, rate = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-7, -1), rng.normal() * 0.3
        found = least_acceleration(REST.value + room, rate, REST, BRAKE, DT, 0.0)
        assert found <= HARDEST * BRAKE + 1e-9
        assert room < 0.0 or found <= max(-rate / DT, 0.0) + 1e-6


@pytest.mark.parametrize("speed", [0.0, 0.1, 0.5])
@pytest.mark.parametrize("below", [5e-4, 0.05])
def test_a_distance_below_its_margin_stops_and_returns(speed: float, below: float) -> None:
    """It goes no deeper than `HARDEST` lets it, and comes back without overshoot."""
    distance, rate, deepest = REST.value - below, -speed, below
    for _ in range(3000):
        x = least_acceleration(distance, rate, REST, BRAKE, DT, 0.0)
        distance += rate * DT + 0.5 * x * DT * DT
        rate += x * DT
        deepest = max(deepest, REST.value - distance)
    assert deepest < below + speed**2 / (2.0 * HARDEST * BRAKE) + 1e-6
    assert distance == pytest.approx(REST.value, abs=1e-6)

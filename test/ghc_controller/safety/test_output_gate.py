"""The output gate and the braking torque behind it."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import make_model, random_state

from ghc_controller.errors import InvalidValue
from ghc_controller.safety.braking import braking_torque
from ghc_controller.safety.gate import (
    APPLIED_UNKNOWN,
    NOT_FINITE,
    RATE_BROKEN,
    TORQUE_LIMIT,
    TORQUE_RATE,
    OutputGate,
)
from ghc_controller.types import Array, Dynamics

DT, RATE = 1e-3, 1000.0  # [s], [Nm/s]
STEP = RATE * DT  # [Nm]
LIMIT = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])  # [Nm]
WILD = np.array([np.nan, np.inf, -np.inf, 1e308, -1e308, 1e3, -1e3, 0.0])


def _wild_torque(rng: np.random.Generator, scale: float = 100.0) -> Array:
    torque = rng.normal(scale=scale, size=7)
    wild = rng.random(7) < 0.2
    torque[wild] = rng.choice(WILD, int(wild.sum()))
    return torque


def test_nothing_impossible_gets_through() -> None:
    """10 000 random inputs with NaN, inf and huge numbers in torque, velocity and dynamics."""
    rng = np.random.default_rng(0)
    gate = OutputGate(LIMIT, RATE, DT)
    applied = np.zeros(7)
    for _ in range(10000):
        mass = rng.choice([1.0, 1.0, np.nan]) * np.eye(7)
        dynamics = Dynamics(mass, rng.choice([1.0, 1.0, np.inf]) * rng.normal(size=7))
        gated = gate.apply(_wild_torque(rng), applied, dynamics, rng.normal(size=7))
        assert np.isfinite(gated.torque).all()
        assert (np.abs(gated.torque) <= LIMIT).all()
        assert (np.abs(gated.torque - applied) <= STEP + 1e-9).all()
        applied = gated.torque
    assert all(gate.counts[name] > 0 for name in (NOT_FINITE, TORQUE_LIMIT, TORQUE_RATE))
    assert gate.counts[RATE_BROKEN] == 0


def test_what_was_applied_may_be_anything_too() -> None:
    """Outside the limits the limits win, and that is counted; not finite: no rate check."""
    rng = np.random.default_rng(1)
    gate = OutputGate(LIMIT, RATE, DT)
    dynamics = Dynamics(np.eye(7), np.zeros(7))
    for _ in range(2000):
        gated = gate.apply(_wild_torque(rng), _wild_torque(rng, 1000.0), dynamics, np.zeros(7))
        assert np.isfinite(gated.torque).all()
        assert (np.abs(gated.torque) <= LIMIT).all()
    assert gate.counts[RATE_BROKEN] > 0
    assert gate.counts[APPLIED_UNKNOWN] > 0


def test_a_good_torque_passes_unchanged_and_uncounted() -> None:
    """Also when it exceeds a bound by rounding only, which is clipped in silence."""
    gate = OutputGate(LIMIT, RATE, DT)
    dynamics = Dynamics(np.eye(7), np.zeros(7))
    torque = np.full(7, 0.5)
    gated = gate.apply(torque, np.zeros(7), dynamics, np.zeros(7))
    assert np.array_equal(gated.torque, torque)
    assert gated.torque is not torque
    rounded = gate.apply(np.full(7, STEP + 1e-8), np.zeros(7), dynamics, np.zeros(7))
    assert np.array_equal(rounded.torque, np.full(7, STEP))
    assert gated.hits == rounded.hits == ()
    assert sum(gate.counts.values()) == 0


def test_each_hit_is_named_and_counted_once_a_tick() -> None:
    """Limit and rate at once, in one tick."""
    gate = OutputGate(LIMIT, RATE, DT)
    dynamics = Dynamics(np.eye(7), np.zeros(7))
    gated = gate.apply(2.0 * LIMIT, LIMIT - 5.0, dynamics, np.zeros(7))
    assert gated.hits == (TORQUE_LIMIT, TORQUE_RATE)
    assert np.allclose(gated.torque, LIMIT - 4.0)
    assert gate.counts[TORQUE_LIMIT] == gate.counts[TORQUE_RATE] == 1


def test_not_finite_is_answered_by_braking() -> None:
    """Within the rate of what was applied."""
    model, state = make_model("kuka_lwr"), random_state("kuka_lwr", np.random.default_rng(2))
    dynamics = model.update(state.q, 0.01 * state.v)
    gate = OutputGate(model.torque_limit, RATE, DT)
    brake = braking_torque(dynamics, 0.01 * state.v, model.torque_limit)
    nothing = np.full(7, np.nan)
    gated = gate.apply(nothing, brake + 0.5, dynamics, 0.01 * state.v)
    assert gated.hits == (NOT_FINITE,)
    assert np.allclose(gated.torque, brake)


def test_before_the_first_torque_and_with_the_rate_off_only_limits_hold() -> None:
    """No rate to measure from, or none wanted."""
    dynamics = Dynamics(np.eye(7), np.zeros(7))
    first = OutputGate(LIMIT, RATE, DT).apply(np.full(7, 30.0), None, dynamics, np.zeros(7))
    off = OutputGate(LIMIT, 0.0, DT).apply(np.full(7, 30.0), np.zeros(7), dynamics, np.zeros(7))
    assert first.hits == off.hits == ()
    assert np.array_equal(first.torque, off.torque)
    assert first.torque[0] == 30.0


def test_bad_limits_are_refused() -> None:
    """Zero torque limit, negative or infinite rate."""
    with pytest.raises(InvalidValue, match="positive numbers expected"):
        OutputGate(np.zeros(7), RATE, DT)
    for rate in (-1.0, np.inf, np.nan):
        with pytest.raises(InvalidValue, match="torque rate limit"):
            OutputGate(LIMIT, rate, DT)


@pytest.mark.parametrize("robot", ["kuka_lwr", "manipulator"])
def test_braking_stops_every_joint_and_holds_it(robot: str) -> None:
    """Closed loop on the model: velocities die out, light wrists included, then nothing moves."""
    model, state = make_model(robot), random_state(robot, np.random.default_rng(3))
    q, v = state.q.copy(), 2.0 * state.v
    limit = np.full(7 if robot == "kuka_lwr" else model.na, 1e3)
    for _ in range(1000):
        dynamics = model.update(q, v)
        torque = braking_torque(dynamics, v, limit)
        v = v + DT * np.linalg.solve(dynamics.mass_matrix, torque - dynamics.bias)
        q = q + DT * v
    assert np.abs(v).max() < 1e-6
    assert np.allclose(braking_torque(model.update(q, 0.0 * v), 0.0 * v, limit), model.gravity())


def test_braking_leaves_a_floating_base_alone_and_respects_limits() -> None:
    """Torques of the joints only."""
    model, state = make_model("humanoid"), random_state("humanoid", np.random.default_rng(4))
    dynamics = model.update(state.q, 100.0 * state.v)
    torque = braking_torque(dynamics, 100.0 * state.v, np.full(model.na, 3.0))
    assert torque.shape == (model.na,)
    assert np.abs(torque).max() == 3.0


def test_each_joint_has_a_rate_limit_of_its_own() -> None:
    """10 000 random torques (seed 2): joint j moves by at most rate_j dt, and reaches that."""
    rng = np.random.default_rng(2)
    rates = np.array([1000.0, 900.0, 800.0, 700.0, 600.0, 200.0, 100.0])
    gate = OutputGate(LIMIT, rates, DT)
    dynamics = Dynamics(np.eye(7), np.zeros(7))
    before, largest = np.zeros(7), np.zeros(7)
    for _ in range(10000):
        torque = gate.apply(_wild_torque(rng), before, dynamics, np.zeros(7)).torque
        largest = np.maximum(largest, np.abs(torque - before))
        before = torque
    np.testing.assert_allclose(largest, rates * DT, rtol=1e-9)

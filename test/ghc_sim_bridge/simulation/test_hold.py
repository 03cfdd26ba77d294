"""The hold brings any moving arm to rest and never asks for more torque than there is."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.safety.braking import BRAKE_TIME, MAX_ACCELERATION, braking_torque
from ghc_controller.types import Array, Dynamics
from ghc_sim_bridge.simulation.simulator import Simulator

STATES = 20


@pytest.fixture(scope="module")
def simulator() -> Simulator:
    return Simulator("kuka_lwr")


def random_state(simulator: Simulator, rng: np.random.Generator) -> tuple[Array, Array]:
    """Anywhere within the position limits, at any speed within the velocity limits."""
    lower, upper = simulator.position_limits.T
    return rng.uniform(lower, upper), rng.uniform(-1.0, 1.0, 7) * simulator.velocity_limit


def test_a_moving_arm_comes_to_rest_within_a_second(simulator: Simulator) -> None:
    rng = np.random.default_rng(11)
    limit = simulator.torque_limit
    for _ in range(STATES):
        simulator.reset(*random_state(simulator, rng))
        for _ in range(1000):
            torque = simulator.hold_torque()
            assert (np.abs(torque) <= limit).all()
            simulator.step(torque)
        assert np.abs(simulator.state().v).max() < 0.01  # [rad/s]


@pytest.mark.parametrize("rate", [1000.0, 300.0])  # [Nm/s]
def test_it_comes_to_rest_under_a_torque_rate_limit_too(simulator: Simulator, rate: float) -> None:
    """No joint faster than 0.5 rad/s after 1 s, no step of a torque beyond rate * dt."""
    rng = np.random.default_rng(12)
    step = rate * simulator.control_dt
    for _ in range(STATES):
        simulator.reset(*random_state(simulator, rng))
        for _ in range(1000):
            before = simulator.torque
            torque = braking_torque(
                simulator.dynamics(),
                simulator.state().v,
                simulator.torque_limit,
                previous=before,
                torque_step=step,
                max_acceleration=np.inf,
            )
            assert np.abs(torque - np.clip(before, *_limits(simulator))).max() <= step + 1e-12
            simulator.step(torque)
        assert np.abs(simulator.state().v).max() < 0.5  # [rad/s]


def test_at_rest_it_is_gravity_compensation(simulator: Simulator) -> None:
    simulator.reset()
    assert simulator.hold_torque() == pytest.approx(simulator.bias(), abs=1e-12)


def test_within_the_limits_every_joint_slows_down_at_the_same_rate(simulator: Simulator) -> None:
    q, v = np.full(7, 0.4), np.array([0.5, -0.4, 0.3, 0.6, -1.0, 1.0, 2.0])
    simulator.reset(q, v)
    simulator.step(simulator.hold_torque())
    assert simulator.acceleration == pytest.approx(-v / BRAKE_TIME, rel=1e-6)


def test_at_the_limits_the_arm_brakes_less_but_straight() -> None:
    """The acceleration stays opposite to the velocity; one torque is at its limit."""
    mass = np.array([[2.0, 0.5], [0.5, 0.1251]])
    velocity, limit = np.array([1.0, -0.5]), np.array([5.0, 5.0])
    torque = braking_torque(Dynamics(mass, np.zeros(2)), velocity, limit)
    acceleration = np.linalg.solve(mass, torque)
    assert np.abs(torque).max() == pytest.approx(5.0)
    assert acceleration / velocity == pytest.approx([acceleration[0]] * 2)
    assert -1.0 / BRAKE_TIME < acceleration[0] < 0.0


def test_a_joint_that_cannot_even_be_carried_does_not_keep_the_others_from_braking() -> None:
    dynamics = Dynamics(np.eye(2), np.array([9.0, 0.0]))
    torque = braking_torque(dynamics, np.array([1.0, 1.0]), np.array([5.0, 50.0]))
    assert torque == pytest.approx([-5.0, -1.0 / BRAKE_TIME])


def test_the_controller_brakes_no_joint_harder_than_its_largest_acceleration() -> None:
    """Where no bound is met; the bridge, which holds, leaves that to the bounds."""
    velocity = np.array([4.0, -0.5])
    dynamics, limit = Dynamics(np.diag([2.0, 0.1]), np.array([1.0, -1.0])), np.full(2, 1e3)
    torque = braking_torque(dynamics, velocity, limit)
    assert torque == pytest.approx([-2.0 * MAX_ACCELERATION + 1.0, 0.1 * 0.5 / BRAKE_TIME - 1.0])
    free = braking_torque(dynamics, velocity, limit, max_acceleration=np.inf)
    assert free == pytest.approx([-2.0 * 4.0 / BRAKE_TIME + 1.0, torque[1]])


def _limits(simulator: Simulator) -> tuple[Array, Array]:
    return -simulator.torque_limit, simulator.torque_limit

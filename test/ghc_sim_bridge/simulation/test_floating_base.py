"""A robot that is fixed to nothing: where it starts, how it falls, how it is held."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from robot_scenes import FLOATING_SCENES

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.safety.torque_gate import TorqueGate
from ghc_controller.types import Array
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.publisher import StatePublisher
from ghc_sim_bridge.simulation.simulator import Simulator
from ghc_sim_bridge.simulation.standing_hold import StandingHold


@pytest.fixture(scope="module", params=FLOATING_SCENES)
def simulator(request: pytest.FixtureRequest) -> Simulator:
    return Simulator(request.param)


def held(simulator: Simulator, seconds: float) -> float:
    """Hold the robot; largest speed (base [m/s], joints [rad/s]) that occurred."""
    hold, fastest = StandingHold(), 0.0
    limit = simulator.torque_limit
    for _ in range(round(seconds / simulator.control_dt)):
        state = simulator.state()
        joints = state.q[-len(limit) :]
        torque = hold.torque(simulator.dynamics(), simulator.contact_jacobian(), joints, state.v)
        simulator.step(np.clip(torque, -limit, limit))
        fastest = max(fastest, float(np.abs(state.v).max()))
    return fastest


def test_it_starts_flat_on_its_frames_at_the_heading(simulator: Simulator) -> None:
    simulator.reset()
    base = simulator.scene.base
    assert base is not None
    middle = np.mean([simulator.frame_position(name) for name in base.stand_on], axis=0)
    assert middle == pytest.approx(base.at, abs=1e-12)
    heading = np.radians(base.heading)
    turn = simulator.frame_rotation(base.stand_on[0])
    assert turn[:, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert turn[:, 0] == pytest.approx([np.cos(heading), np.sin(heading), 0.0], abs=1e-12)


def test_at_the_start_its_contacts_carry_its_weight(simulator: Simulator) -> None:
    """Within a fifth, from the first step on: no drop, no jump."""
    simulator.reset()
    simulator.step(simulator.torque)
    weight = float(simulator.model.body_mass.sum()) * 9.81
    carried = sum(wrench[2] for wrench in simulator.contact_wrenches().values())
    assert carried == pytest.approx(weight, rel=0.2)
    assert all(wrench[2] > 5.0 for wrench in simulator.contact_wrenches().values())


def test_limits_of_the_robot_file_hold_for_the_motors(simulator: Simulator) -> None:
    assert simulator.torque_limit.max() < 100.0
    assert simulator.velocity_limit.max() < 10.0


def test_held_it_stays_as_it_is(simulator: Simulator) -> None:
    simulator.reset()
    held(simulator, 1.0)
    state = simulator.state()
    assert state.q[:3] == pytest.approx(simulator.start[:3], abs=5e-3)
    assert np.abs(state.q[7:] - simulator.start[7:]).max() < 0.02
    assert np.abs(state.v).max() < 0.02


def test_held_it_swallows_a_push(simulator: Simulator) -> None:
    rng = np.random.default_rng(8)
    simulator.reset(v=rng.normal(0.0, 0.05, simulator.nv))
    held(simulator, 1.0)
    assert np.abs(simulator.state().v).max() < 0.05
    assert simulator.state().q[2] == pytest.approx(simulator.start[2], abs=0.02)


def test_dropped_while_held_it_falls_and_nothing_explodes(simulator: Simulator) -> None:
    """From half a meter, tilted by half a radian: light wrists whip at the impact, no more."""
    q = simulator.start.copy()
    q[2] += 0.5
    q[3:7] = _times(q[3:7], np.array([np.sin(0.25), 0.0, 0.0, np.cos(0.25)]))
    simulator.reset(q)
    before = simulator.state().v
    held(simulator, 0.1)
    after = simulator.state().v
    turn = simulator.frame_rotation(simulator.base_frame)
    assert (turn @ (after - before)[:3])[2] == pytest.approx(-0.981, abs=0.1)
    assert held(simulator, 1.0) < 200.0


def test_free_flight_has_no_contact_and_keeps_the_momentum(simulator: Simulator) -> None:
    """The center of mass falls freely, whatever the motors do."""
    rng = np.random.default_rng(9)
    q = simulator.start.copy()
    q[2] += 1.0
    simulator.reset(q, rng.normal(0.0, 0.2, simulator.nv))
    assert simulator.contact_jacobian().shape == (0, simulator.nv)
    start, velocity = _mass_centre(simulator), _mass_velocity(simulator)
    for _ in range(100):
        simulator.step(rng.uniform(-0.3, 0.3, len(simulator.joint_names)))
    fall = velocity * 0.1 + np.array([0.0, 0.0, -9.81]) * 0.1 * 0.101 / 2.0
    assert _mass_centre(simulator) - start == pytest.approx(fall, abs=1e-4)


def test_the_state_goes_out_with_its_companions_first(simulator: Simulator) -> None:
    """Wrenches and odometry before the joint state that they belong to, the clock last."""
    simulator.reset()
    gate = TorqueGate(simulator.torque_limit, 0.0, simulator.control_dt)
    cycle = ControlCycle(simulator, gate, None)
    sent: list[str] = []

    def send(name: str) -> Callable[[bytes], None]:
        return lambda _: sent.append(name)

    names = list(simulator.contact_wrenches())
    publisher = StatePublisher(
        send("joint_states"),
        send("clock"),
        {name: send(name) for name in names},
        odometry=send("odom"),
    )
    for _ in range(2):  # a repeat sends everything again
        sent.clear()
        publisher.publish(cycle)
        assert sent == [*names, "odom", "joint_states", "clock"]


def test_a_hold_keeps_the_posture_that_the_last_command_left(simulator: Simulator) -> None:
    simulator.reset()
    limit = simulator.torque_limit
    cycle = ControlCycle(simulator, TorqueGate(limit, 0.0, simulator.control_dt), None)
    for _ in range(20):
        cycle.advance(0.9 * simulator.torque)  # it sinks a little
    left = cycle.joint_state[0].copy()
    for _ in range(600):
        assert (np.abs(cycle.advance(None).torque) <= limit).all()
    assert np.abs(cycle.joint_state[0] - left).max() < 0.1
    assert np.abs(cycle.joint_state[1]).max() < 0.1


def test_a_configuration_that_is_none_is_refused(simulator: Simulator) -> None:
    q = simulator.start.copy()
    q[3:7] *= 1.1
    with pytest.raises(InvalidValue, match=r"quaternion of the base has the norm 1\.1, 1 expect"):
        simulator.reset(q)
    with pytest.raises(WrongSize, match="posture of the base and "):
        simulator.reset(q[7:])
    q = simulator.start.copy()
    q[1] = np.nan
    with pytest.raises(InvalidValue, match="posture of the base is nan"):
        simulator.reset(q)
    simulator.reset()


def _mass_centre(simulator: Simulator) -> Array:
    return np.array(simulator.data.subtree_com[0])


def _mass_velocity(simulator: Simulator) -> Array:
    mass = float(simulator.model.body_mass.sum())
    turn = simulator.frame_rotation(simulator.base_frame)
    momentum = simulator.mass_matrix()[:3] @ simulator.state().v
    return np.asarray(turn @ momentum / mass)


def _times(p: Array, q: Array) -> Array:
    """Product of quaternions xyzw."""
    vector = p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3])
    return np.append(vector, p[3] * q[3] - p[:3] @ q[:3])

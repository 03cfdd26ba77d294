"""Disturbances of the simulator: inside their magnitudes, repeatable, and unknown to the log."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from ghc_controller.errors import UnknownName
from ghc_controller.safety.torque_gate import TorqueGate
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.simulation.disturbances import Disturbances, Magnitudes
from ghc_sim_bridge.simulation.simulator import Simulator

SCENE = "kuka_lwr_plane"
ALL = Magnitudes(
    mass=0.05,
    friction_lower=0.6,
    friction_upper=1.0,
    push=20.0,
    push_frame="lwr_arm_7_link",
    push_duration=0.1,
    push_from=0.2,
    push_until=0.5,
    velocity_noise=1e-3,
)


def frame_of(simulator: Simulator) -> str:
    """Some frame near the end of the arm."""
    return str(simulator.model.site(simulator.model.nsite - 1).name)


def magnitudes(**changes: object) -> Magnitudes:
    """Those above, pushed where the arm has a frame."""
    values = {name: getattr(ALL, name) for name in ALL.__dataclass_fields__}
    values["push_frame"] = frame_of(Simulator(SCENE))
    return Magnitudes(**(values | changes))


def disturbed(seed: int, **changes: object) -> Simulator:
    return Simulator(SCENE, disturbances=Disturbances(magnitudes(**changes), seed))


@pytest.mark.parametrize("seed", range(5))
def test_masses_and_friction_stay_within_their_magnitudes(seed: int) -> None:
    plain, other = Simulator(SCENE).model, disturbed(seed).model
    heavy = plain.body_mass > 0.0
    ratio = other.body_mass[heavy] / plain.body_mass[heavy]
    assert np.abs(ratio - 1.0).max() <= 0.05
    assert np.ptp(ratio) > 0.0
    touching = (other.geom_contype != 0) & (other.geom_condim > 1)
    assert (
        (other.geom_friction[touching, 0] >= 0.6) & (other.geom_friction[touching, 0] <= 1)
    ).all()


def test_the_same_seed_gives_the_same_run_and_another_one_another() -> None:
    def end(seed: int) -> np.ndarray:
        simulator = disturbed(seed)
        for _ in range(600):
            simulator.step(simulator.bias())
        return np.asarray(simulator.state().q)

    np.testing.assert_array_equal(end(3), end(3))
    assert np.abs(end(3) - end(4)).max() > 1e-6


def test_a_push_acts_for_its_duration_between_its_times() -> None:
    disturbances = Disturbances(magnitudes(mass=0.0), 7)
    simulator = Simulator(SCENE, disturbances=disturbances)
    pushed = []
    for _ in range(700):
        simulator.step(simulator.bias())
        force = simulator.data.xfrc_applied[:, :3]
        if np.abs(force).max() > 0.0:
            pushed.append(simulator.time - simulator.control_dt)
            assert np.linalg.norm(force) == pytest.approx(20.0)
    assert len(pushed) in (100, 101)
    assert 0.2 - 1e-3 <= pushed[0] <= 0.5 + 1e-3


def test_nothing_changes_where_every_magnitude_is_zero() -> None:
    plain, other = Simulator(SCENE), Simulator(SCENE, disturbances=Disturbances(Magnitudes(), 1))
    np.testing.assert_array_equal(plain.model.body_mass, other.model.body_mass)
    np.testing.assert_array_equal(plain.model.geom_friction, other.model.geom_friction)
    for simulator in (plain, other):
        simulator.step(simulator.bias())
    np.testing.assert_array_equal(plain.state().q, other.state().q)


def test_noise_is_in_what_is_measured_and_not_in_the_state() -> None:
    simulator = disturbed(2, push=0.0)
    gate = TorqueGate(simulator.torque_limit, 0.0, simulator.control_dt)
    cycle = ControlCycle(simulator, gate, None)
    noise = []
    for _ in range(300):
        cycle.advance(simulator.bias())
        assert cycle.measured[1] is cycle.measured[1]  # a repeated state is the same state
        noise.append(cycle.measured[1] - cycle.joint_state[1])
        np.testing.assert_array_equal(cycle.measured[0], cycle.joint_state[0])
    assert np.std(noise) == pytest.approx(1e-3, rel=0.1)


def test_a_frame_that_does_not_exist_cannot_be_pushed() -> None:
    model = mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")
    with pytest.raises(UnknownName, match="nose"):
        Disturbances(Magnitudes(push=1.0, push_frame="nose"), 0).change(model)

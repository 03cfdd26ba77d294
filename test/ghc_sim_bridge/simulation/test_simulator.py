"""Properties of the simulator: time, energy, accuracy, reset, rejections."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.types import Array
from ghc_sim_bridge.errors import SimulationDiverged
from ghc_sim_bridge.simulation.simulator import Simulator
from ghc_sim_bridge.simulation.timing import count_substeps

FORWARD = np.array([0.0, -0.5, 0.0, 1.5, 0.0, -1.1, 0.0])  # [rad] bent, tool down


def energy(simulator: Simulator) -> float:
    """Kinetic plus potential energy [J], from MuJoCo's own masses and heights."""
    v, model, data = simulator.state().v, simulator.model, simulator.data
    height = float(model.body_mass @ data.xipos[:, 2])
    return 0.5 * float(v @ simulator.mass_matrix() @ v) - model.opt.gravity[2] * height


def at_an_end_stop(simulator: Simulator) -> bool:
    """Whether a joint touches the end of its range, which takes energy away."""
    lower, upper = simulator.position_limits.T
    q = simulator.state().q
    return bool((q < lower).any() or (q > upper).any())


def swing(simulator: Simulator, seconds: float) -> float:
    """Largest drift of the energy [J] of the arm swinging freely from a seeded state."""
    rng = np.random.default_rng(5)
    simulator.reset(FORWARD + rng.normal(0.0, 0.1, 7), rng.normal(0.0, 0.3, 7))
    start, drift = energy(simulator), 0.0
    for _ in range(round(seconds / simulator.control_dt)):
        simulator.step(np.zeros(7))
        drift = max(drift, abs(energy(simulator) - start))
        assert not at_an_end_stop(simulator)
    return drift


def test_energy_is_kept_and_the_error_shrinks_with_the_step() -> None:
    coarse = swing(Simulator("kuka_lwr", 1e-3, 1e-3), 0.3)
    fine = swing(Simulator("kuka_lwr", 1e-3, 1e-4), 0.3)
    assert coarse < 0.2  # [J] of about 80 J that are exchanged
    assert fine < 0.15 * coarse


def test_work_of_the_torques_becomes_energy() -> None:
    simulator = Simulator("kuka_lwr", 1e-3, 1e-4)
    simulator.reset(FORWARD)
    before, work = energy(simulator), 0.0
    push = np.array([10.0, -5.0, 3.0, 2.0, 0.1, 0.1, 0.001])  # [Nm] beyond the weight
    for _ in range(200):
        torque = simulator.bias() + push
        q = simulator.state().q
        simulator.step(torque)
        work += float(torque @ (simulator.state().q - q))
        assert not at_an_end_stop(simulator)
    assert work > 1.0  # [J]
    assert energy(simulator) - before == pytest.approx(work, rel=2e-3)


def test_velocity_and_acceleration_are_the_differences_of_what_they_derive() -> None:
    simulator = Simulator("kuka_lwr")
    rng = np.random.default_rng(6)
    for _ in range(50):
        before = simulator.state()
        simulator.step(simulator.bias() + rng.normal(0.0, 0.05, 7))
        after = simulator.state()
        dt = after.time - before.time
        assert (after.v - before.v) / dt == pytest.approx(simulator.acceleration, abs=1e-8)
        assert (after.q - before.q) / dt == pytest.approx(after.v, abs=1e-8)


def test_a_jacobian_is_the_derivative_of_its_frame() -> None:
    simulator = Simulator("kuka_lwr")
    rng = np.random.default_rng(7)
    for _ in range(20):
        q, v = rng.uniform(-1.5, 1.5, 7), rng.normal(size=7)
        simulator.reset(q)
        velocity = simulator.frame_jacobian("tool")[:3] @ v
        ends = []
        for side in (-1e-6, 1e-6):
            simulator.reset(q + side * v)
            ends.append(simulator.frame_position("tool"))
        assert (ends[1] - ends[0]) / 2e-6 == pytest.approx(velocity, abs=1e-7)


def test_the_carried_arm_stays_where_it_is() -> None:
    simulator = Simulator("kuka_lwr")
    for _ in range(1000):
        simulator.step(simulator.bias())
    assert np.abs(simulator.state().q - simulator.start).max() < 1e-9


def test_time_is_an_exact_count_of_periods() -> None:
    simulator = Simulator("kuka_lwr", control_dt=0.003, physics_dt=0.001)
    for _ in range(700):
        simulator.step(simulator.torque)
    assert simulator.tick == 700
    assert simulator.time == 700 * 0.003
    assert simulator.data.time == pytest.approx(2.1)


def test_substeps_do_not_change_what_is_simulated() -> None:
    """The same torque held over the same time ends in the same place, to the step's accuracy."""
    ends = []
    for control_dt in (0.001, 0.01):
        simulator = Simulator("kuka_lwr", control_dt, 0.001)
        torque = simulator.bias() + np.array([1.0, 1.0, 0.5, 0.5, 0.05, 0.05, 0.0001])
        for _ in range(round(0.1 / control_dt)):
            simulator.step(torque)
        ends.append(simulator.state().q)
    assert ends[0] == pytest.approx(ends[1], abs=1e-12)


def test_a_reset_forgets_everything_but_the_epoch() -> None:
    simulator = Simulator("kuka_lwr_plane")
    first: list[Array] = []
    for epoch in range(2):
        assert simulator.state().epoch == epoch
        rng = np.random.default_rng(8)
        for _ in range(300):
            shake = rng.normal(0.0, 0.02, 7) * simulator.torque_limit
            simulator.step(simulator.bias() + shake)
        last = simulator.state()
        first = first or [last.q, last.v]
        assert np.array_equal(last.q, first[0]) and np.array_equal(last.v, first[1])
        simulator.reset()
        state = simulator.state()
        assert state.time == 0.0 and np.array_equal(state.q, simulator.start)
        assert state.torque is not None
        assert state.torque == pytest.approx(simulator.bias())


def test_a_state_does_not_change_after_it_was_given_away() -> None:
    simulator = Simulator("kuka_lwr_plane")
    state = simulator.state()
    kept = [state.q.copy(), state.v.copy(), state.wrenches["tool"].copy()]
    for _ in range(20):
        simulator.step(np.zeros(7))
    assert np.array_equal(kept[0], state.q) and np.array_equal(kept[1], state.v)
    assert np.array_equal(kept[2], state.wrenches["tool"])


def test_divergence_is_an_error_that_names_the_joint() -> None:
    simulator = Simulator("kuka_lwr")
    with pytest.raises(SimulationDiverged, match=r"t = 0\.\d+ s: velocity of joint_7") as info:
        for _ in range(100):
            simulator.step(simulator.bias() + np.array([0.0] * 6 + [38.0]))
    assert info.value.joint == "joint_7"


@pytest.mark.parametrize(
    ("torque", "message"),
    [
        (np.zeros(6), r"torque of joint_1, .*size \(6,\) given, \(7,\) expected"),
        (np.array([0.0] * 3 + [np.nan] + [0.0] * 3), "torque of joint_4 is nan"),
        (np.array([0.0] * 6 + [np.inf]), "torque of joint_7 is inf"),
    ],
)
def test_a_torque_that_is_none_is_refused(torque: Array, message: str) -> None:
    simulator = Simulator("kuka_lwr")
    with pytest.raises((WrongSize, InvalidValue), match=message):
        simulator.step(torque)
    assert simulator.tick == 0


@pytest.mark.parametrize(
    ("control_dt", "physics_dt", "substeps"),
    [(0.001, 0.001, 1), (0.01, 0.001, 10), (0.003, 0.0005, 6), (0.1, 0.1 / 3.0, 3)],
)
def test_periods_that_fit(control_dt: float, physics_dt: float, substeps: int) -> None:
    assert count_substeps(control_dt, physics_dt) == substeps


@pytest.mark.parametrize(
    ("control_dt", "physics_dt", "message"),
    [
        (0.001, 0.0007, r"0\.001 s .* 0\.0007 s"),
        (0.001, 0.002, r"0\.001 s .* 0\.002 s"),
        (0.0, 0.001, "must be positive"),
        (0.001, -0.001, "must be positive"),
        (float("nan"), 0.001, "must be positive"),
    ],
)
def test_periods_that_do_not_fit(control_dt: float, physics_dt: float, message: str) -> None:
    with pytest.raises(InvalidValue, match=message):
        count_substeps(control_dt, physics_dt)


def test_an_unknown_frame_is_refused_with_the_ones_that_exist() -> None:
    with pytest.raises(UnknownName, match=r"unknown frame 'wrist'; known: .*elbow, .*tool"):
        Simulator("kuka_lwr").frame_position("wrist")


def test_a_robot_model_may_count_its_joints_in_another_order() -> None:
    plain = Simulator("kuka_lwr")
    order = [3, 0, 6, 1, 5, 2, 4]
    other = Simulator("kuka_lwr", joint_names=[plain.joint_names[k] for k in order])
    rng = np.random.default_rng(9)
    q, v, extra = rng.uniform(-1, 1, 7), rng.uniform(-1, 1, 7), rng.normal(0.0, 0.01, 7)
    plain.reset(q, v)
    other.reset(q[order], v[order])
    assert np.array_equal(other.mass_matrix(), plain.mass_matrix()[np.ix_(order, order)])
    assert np.array_equal(other.frame_jacobian("tool"), plain.frame_jacobian("tool")[:, order])
    assert np.array_equal(other.torque_limit, plain.torque_limit[order])
    for _ in range(50):
        plain.step(plain.bias() + extra)
        other.step(other.bias() + extra[order])
    assert np.array_equal(other.state().q, plain.state().q[order])
    assert np.array_equal(other.start, plain.start[order])

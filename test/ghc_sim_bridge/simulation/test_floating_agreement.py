"""MuJoCo and Pinocchio, both fed by the URDF, are the same robot with a floating base too."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio
import pytest
from robot_scenes import FLOATING_SCENES

from ghc_controller.types import Array
from ghc_sim_bridge.simulation.simulator import Simulator

STATES = 30
TOLERANCE = 1e-9


@pytest.fixture(scope="module", params=FLOATING_SCENES)
def simulator(request: pytest.FixtureRequest) -> Simulator:
    """In the joint order of the model, which is not that of the file."""
    plain = Simulator(request.param)
    model = _model(plain)
    return Simulator(request.param, joint_names=tuple(model.names)[2:])


@pytest.fixture(scope="module")
def engine(simulator: Simulator) -> tuple[pinocchio.Model, pinocchio.Data]:
    model = _model(simulator)
    assert tuple(model.names)[2:] == simulator.joint_names
    assert (model.nq, model.nv) == (simulator.nq, simulator.nv)
    return model, model.createData()


def _model(simulator: Simulator) -> pinocchio.Model:
    return pinocchio.buildModelFromUrdf(str(simulator.scene.urdf), pinocchio.JointModelFreeFlyer())


def random_states(simulator: Simulator, seed: int) -> Iterator[tuple[Array, Array]]:
    """Joints within their limits, the base anywhere, turned anyhow, moving and turning."""
    rng = np.random.default_rng(seed)
    lower, upper = simulator.position_limits.T
    for _ in range(STATES):
        turn = rng.normal(size=4)
        base = np.concatenate([rng.uniform(1.0, 3.0, 3), turn / np.linalg.norm(turn)])
        q = np.concatenate([base, rng.uniform(lower, upper)])
        v = rng.normal(size=simulator.nv)
        simulator.reset(q, v)
        state = simulator.state()
        assert np.abs(state.q - q).max() < 1e-12
        assert np.abs(state.v - v).max() < 1e-12
        yield q, v


def mass_matrix(model: pinocchio.Model, data: pinocchio.Data, q: Array) -> Array:
    upper = np.triu(pinocchio.crba(model, data, q))
    return upper + np.triu(upper, 1).T


def test_mass_matrices_agree(
    simulator: Simulator, engine: tuple[pinocchio.Model, pinocchio.Data]
) -> None:
    for q, _ in random_states(simulator, seed=1):
        assert np.abs(simulator.mass_matrix() - mass_matrix(*engine, q)).max() < TOLERANCE


def test_biases_agree(
    simulator: Simulator, engine: tuple[pinocchio.Model, pinocchio.Data]
) -> None:
    for q, v in random_states(simulator, seed=2):
        expected = pinocchio.nonLinearEffects(*engine, q, v)
        assert np.abs(simulator.bias() - expected).max() < TOLERANCE


@pytest.mark.parametrize("frame", ["l_sole", "r_hand_dh_frame", "root_link", "chest"])
def test_frames_and_jacobians_agree(
    simulator: Simulator, engine: tuple[pinocchio.Model, pinocchio.Data], frame: str
) -> None:
    model, data = engine
    index = model.getFrameId(frame, pinocchio.FrameType.BODY)
    for q, _ in random_states(simulator, seed=3):
        pinocchio.computeJointJacobians(model, data, q)
        pinocchio.updateFramePlacements(model, data)
        jacobian = pinocchio.getFrameJacobian(model, data, index, pinocchio.LOCAL_WORLD_ALIGNED)
        place = data.oMf[index]
        assert np.abs(simulator.frame_jacobian(frame) - jacobian).max() < TOLERANCE
        assert np.abs(simulator.frame_position(frame) - place.translation).max() < TOLERANCE
        assert np.abs(simulator.frame_rotation(frame) - place.rotation).max() < TOLERANCE


def test_a_free_step_is_that_of_the_equation_of_motion(
    simulator: Simulator, engine: tuple[pinocchio.Model, pinocchio.Data]
) -> None:
    """In free flight the joints get, over one step, what forward dynamics says they get."""
    rng = np.random.default_rng(4)
    model, data = engine
    middle = simulator.position_limits.mean(axis=1)
    for q, v in random_states(simulator, seed=4):
        q[7:] = middle  # away from the end stops
        simulator.reset(q, v)
        torque = rng.uniform(-0.5, 0.5, len(simulator.joint_names))
        expected = pinocchio.aba(model, data, q, v, np.concatenate([np.zeros(6), torque]))[6:]
        simulator.step(torque)
        assert np.abs(simulator.acceleration - expected).max() < 1e-6 * np.abs(expected).max()


def test_contact_wrenches_close_the_equation_of_motion(simulator: Simulator) -> None:
    """M dv/dt + h = S^T tau + sum J^T w on all coordinates, base included, while it stands."""
    simulator.reset()
    contacts = {contact.name: contact.frame for contact in simulator.scene.contacts}
    for _ in range(50):
        before = simulator.state()
        mass, bias = simulator.mass_matrix(), simulator.bias()
        jacobians = {name: simulator.frame_jacobian(frame) for name, frame in contacts.items()}
        torque = simulator.torque
        simulator.step(torque)
        after = simulator.state()
        # The base's axes turn during the step, less than the second digit of its acceleration.
        change = (after.v - before.v) / simulator.control_dt
        change[:3] += np.cross(before.v[3:6], before.v[:3])
        force = sum(
            jacobians[name].T @ wrench for name, wrench in simulator.contact_wrenches().items()
        )
        left = mass @ change + bias
        left[6:] -= torque
        left -= mass[:, :3] @ np.cross(before.v[3:6], before.v[:3])
        assert np.abs(left - force).max() < 1e-2

"""MuJoCo and Pinocchio, both fed by the URDF, are the same robot."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio
import pytest
from robot_scenes import FIXED_SCENES

from ghc_controller.types import Array
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.simulator import Simulator

STATES = 100
TOLERANCE = 1e-9

State = tuple[Array, Array]


@pytest.fixture(params=FIXED_SCENES)
def simulator(request: pytest.FixtureRequest) -> Simulator:
    scene = load_scene(request.param)
    names = list(pinocchio.buildModelFromUrdf(str(scene.urdf)).names)[1:]
    return Simulator(scene, joint_names=names)


def random_states(simulator: Simulator, seed: int) -> Iterator[State]:
    """Postures within the position limits, velocities within the velocity limits."""
    rng = np.random.default_rng(seed)
    lower, upper = simulator.position_limits.T
    for _ in range(STATES):
        q = rng.uniform(lower, upper)
        v = rng.uniform(-1.0, 1.0, len(q)) * simulator.velocity_limit
        simulator.reset(q, v)
        yield q, v


def frames_of(simulator: Simulator) -> tuple[str, str]:
    """A frame in the middle of the robot, and one at its end."""
    frames = {
        "icub_fencer": ("chest", "sword_tip"),
        "icub_upper_body": ("l_elbow_1", "l_hand_dh_frame"),
        "two_arms": ("left_elbow", "right_tool"),
    }
    return frames.get(simulator.scene.name, ("elbow", "tool"))


def pinocchio_model(simulator: Simulator) -> tuple[pinocchio.Model, pinocchio.Data]:
    model = pinocchio.buildModelFromUrdf(str(simulator.scene.urdf))
    assert tuple(model.names)[1:] == simulator.joint_names
    return model, model.createData()


def test_mass_matrices_agree(simulator: Simulator) -> None:
    model, data = pinocchio_model(simulator)
    for q, _ in random_states(simulator, seed=1):
        upper = np.triu(pinocchio.crba(model, data, q))
        expected = upper + np.triu(upper, 1).T
        assert np.abs(simulator.mass_matrix() - expected).max() < TOLERANCE


def test_bias_torques_agree(simulator: Simulator) -> None:
    model, data = pinocchio_model(simulator)
    for q, v in random_states(simulator, seed=2):
        expected = pinocchio.nonLinearEffects(model, data, q, v)
        assert np.abs(simulator.bias() - expected).max() < TOLERANCE


@pytest.mark.parametrize("which", [0, 1])
def test_frames_and_jacobians_agree(simulator: Simulator, which: int) -> None:
    model, data = pinocchio_model(simulator)
    frame = frames_of(simulator)[which]
    index = model.getFrameId(frame)
    for q, _ in random_states(simulator, seed=3):
        pinocchio.computeJointJacobians(model, data, q)
        pinocchio.updateFramePlacements(model, data)
        jacobian = pinocchio.getFrameJacobian(model, data, index, pinocchio.LOCAL_WORLD_ALIGNED)
        place = data.oMf[index]
        assert np.abs(simulator.frame_jacobian(frame) - jacobian).max() < TOLERANCE
        assert np.abs(simulator.frame_position(frame) - place.translation).max() < TOLERANCE
        assert np.abs(simulator.frame_rotation(frame) - place.rotation).max() < TOLERANCE


def test_acceleration_of_a_free_step_is_that_of_the_equation_of_motion(
    simulator: Simulator,
) -> None:
    """v(t + dt) = v + dt M^-1 (tau - h): what inverse dynamics asks for happens to rounding."""
    rng = np.random.default_rng(4)
    for q, v in random_states(simulator, seed=4):
        # Away from the end stops and the table, where nothing but the torque acts.
        middle = simulator.position_limits.mean(axis=1)
        simulator.reset(middle + 0.9 * (q - middle), v)
        if any(np.abs(w).max() > 0.0 for w in simulator.contact_wrenches().values()):
            continue
        tip = frames_of(simulator)[1]
        if simulator.scene.contacts and simulator.frame_position(tip)[2] < 0.4:
            continue
        wanted = rng.uniform(-20.0, 20.0, len(q))  # [rad/s^2]
        simulator.step(simulator.mass_matrix() @ wanted + simulator.bias())
        assert np.abs(simulator.acceleration - wanted).max() < 1e-7

"""A posture stands where the simulator would put the robot."""

from __future__ import annotations

import pytest
from robot_scenes import FLOATING_SCENES

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.robot import load_robot_config
from ghc_sim_bridge.scenario.posture_motion import configuration
from ghc_sim_bridge.scene.values import BaseStart
from ghc_sim_bridge.simulation.simulator import Simulator


@pytest.fixture(params=FLOATING_SCENES[:1])
def simulator(request: pytest.FixtureRequest) -> Simulator:
    return Simulator(request.param)


@pytest.fixture
def model(simulator: Simulator) -> RobotModel:
    return load_robot_config(simulator.scene.robot_file).model


def _base(simulator: Simulator) -> BaseStart:
    assert simulator.scene.base is not None
    return simulator.scene.base


def test_a_posture_stands_where_the_simulator_puts_it(
    simulator: Simulator, model: RobotModel
) -> None:
    order = [simulator.joint_names.index(name) for name in model.joint_names]
    q = configuration(model, _base(simulator), simulator.start[7:][order])
    assert q[:7] == pytest.approx(simulator.start[:7], abs=1e-9)
    assert model.center_of_mass() == pytest.approx(simulator.data.subtree_com[0], abs=1e-9)

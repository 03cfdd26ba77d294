"""Motions between postures: they begin and end where the simulator would put the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from robot_scenes import FLOATING_SCENES

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.robot import load_robot_config
from ghc_sim_bridge.scenario.posture_motion import (
    Posture,
    configuration,
    minimum_jerk,
    sampled_motion,
)
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


def _deeper(start: Mapping[str, float]) -> dict[str, float]:
    """Another posture."""
    return {name: 1.2 * angle for name, angle in start.items()}


def test_a_posture_stands_where_the_simulator_puts_it(
    simulator: Simulator, model: RobotModel
) -> None:
    order = [simulator.joint_names.index(name) for name in model.joint_names]
    q = configuration(model, _base(simulator), simulator.start[7:][order])
    assert q[:7] == pytest.approx(simulator.start[:7], abs=1e-9)
    assert model.center_of_mass() == pytest.approx(simulator.data.subtree_com[0], abs=1e-9)


def test_a_motion_goes_from_one_posture_to_the_next_and_rests_there(
    simulator: Simulator, model: RobotModel
) -> None:
    start = simulator.scene.start
    postures = [Posture(1.0, start), Posture(2.0, _deeper(start)), Posture(2.5, start)]
    times, centre = sampled_motion(
        model, _base(simulator), postures, RobotModel.center_of_mass, step=0.01
    )
    assert (times[0], times[-1]) == (1.0, 2.5)
    assert np.diff(times) == pytest.approx(np.full(150, 0.01))
    assert centre[0] == pytest.approx(simulator.data.subtree_com[0], abs=1e-9)
    assert centre[-1] == pytest.approx(centre[0], abs=1e-9)
    deep = Simulator(replace(simulator.scene, start=_deeper(start)))
    assert centre[100] == pytest.approx(deep.data.subtree_com[0], abs=1e-9)
    speed = np.linalg.norm(np.diff(centre, axis=0), axis=1) / 0.01
    assert speed[[0, 99, 100, -1]].max() < 0.05 * speed.max()


def test_minimum_jerk_is_at_rest_at_both_ends() -> None:
    assert [minimum_jerk(x) for x in (0.0, 0.5, 1.0)] == pytest.approx([0.0, 0.5, 1.0])
    for end in (1e-4, 1.0 - 1e-4):
        assert abs(minimum_jerk(end) - round(end)) < 1e-10


def test_what_is_no_motion_is_refused(simulator: Simulator, model: RobotModel) -> None:
    base, read = _base(simulator), RobotModel.center_of_mass
    with pytest.raises(InvalidValue, match="two or more postures at increasing times expected"):
        sampled_motion(model, base, [Posture(0.0, {})], read)
    with pytest.raises(InvalidValue, match="increasing times"):
        sampled_motion(model, base, [Posture(1.0, {}), Posture(1.0, {})], read)
    with pytest.raises(UnknownName, match="unknown joint 'tail'"):
        sampled_motion(model, base, [Posture(0.0, {"tail": 1.0}), Posture(1.0, {})], read)

"""A log with a floating base: it comes back from its file, and is drawn where the base was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robot_scenes import FLOATING_SCENES

from ghc_controller.errors import InvalidValue
from ghc_controller.safety.torque_gate import TorqueGate
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.errors import RenderingUnavailable
from ghc_sim_bridge.figures.filmstrip import log_filmstrip, write_filmstrip
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, FullRateLogBuffer
from ghc_sim_bridge.simulation.rendering import GAP
from ghc_sim_bridge.simulation.simulator import Simulator
from ghc_sim_bridge.viewer.robot import RerunRobot

SIZE = (160, 200)


@pytest.fixture(scope="module", params=FLOATING_SCENES[:1])
def simulator(request: pytest.FixtureRequest) -> Simulator:
    return Simulator(request.param)


@pytest.fixture(scope="module")
def log(simulator: Simulator, tmp_path_factory: pytest.TempPathFactory) -> FullRateLog:
    """Limp joints: it sinks to its knees in a third of a second."""
    simulator.reset()
    buffer = FullRateLogBuffer(
        simulator.joint_names,
        tuple(simulator.contact_wrenches()),
        simulator.control_dt,
        simulator.floating_base,
    )
    gate = TorqueGate(simulator.torque_limit, 0.0, simulator.control_dt)
    cycle = ControlCycle(simulator, gate, buffer)
    for _ in range(300):
        cycle.advance(np.zeros(len(simulator.joint_names)))
    path = tmp_path_factory.mktemp("log") / "log.npz"
    buffer.save(path)
    return FullRateLog.load(path)


def test_the_log_holds_the_whole_state(log: FullRateLog, simulator: Simulator) -> None:
    assert log.base_pose is not None and log.base_velocity is not None
    assert log.base_pose.shape == (300, 7) and log.base_velocity.shape == (300, 6)
    assert log.configuration(0) == pytest.approx(simulator.start)
    for row in (0, 120, 298):
        simulator.reset(log.configuration(row), log.velocity(row))
        simulator.step(log.torque[row])
        assert simulator.state().q == pytest.approx(log.configuration(row + 1), abs=1e-6)
    backwards = log.joint_names[::-1]
    assert log.configuration(5, backwards)[7:].tolist() == log.q[5, ::-1].tolist()


def test_the_strip_shows_the_fall(log: FullRateLog, simulator: Simulator, tmp_path: Path) -> None:
    try:
        strip = log_filmstrip(log, simulator.scene, (0.0, 0.0, 0.299), SIZE)
    except RenderingUnavailable:
        return  # what it says is checked in test_rendering
    width, height = SIZE
    assert strip.shape == (height, 3 * width + 2 * GAP, 3)
    first, again, last = (strip[:, k * (width + GAP) :][:, :width].astype(int) for k in range(3))
    assert np.abs(first - again).mean() < 0.01
    assert np.abs(first - last).mean() > 2.0
    write_filmstrip(tmp_path / "strip.png", log, simulator.scene, (0.1,))
    assert 10_000 < (tmp_path / "strip.png").stat().st_size < 300_000


def test_an_empty_log_is_refused(simulator: Simulator, tmp_path: Path) -> None:
    buffer = FullRateLogBuffer(simulator.joint_names, (), simulator.control_dt, True)
    buffer.save(tmp_path / "log.npz")
    with pytest.raises(InvalidValue, match="the log is empty"):
        log_filmstrip(FullRateLog.load(tmp_path / "log.npz"), simulator.scene)


def test_the_views_show_the_base_where_it_was(log: FullRateLog, simulator: Simulator) -> None:
    assert log.base_pose is not None
    robot = RerunRobot(simulator.scene.urdf, log.joint_names, floating_base=True)
    rows = [0, 150, 299]
    places = robot.placements(log.q[rows], log.base_pose[rows])
    pose = np.hstack(places["world/robot/root_joint"])
    assert pose == pytest.approx(log.base_pose[rows])

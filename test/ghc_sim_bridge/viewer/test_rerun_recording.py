"""A run as a Rerun recording: the arm where the simulator has it, peaks not lost, one file."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError
from ghc_controller.safety.torque_gate import TorqueGate
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.logs.controller_series import ControllerSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, FullRateLogBuffer
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.simulator import Simulator
from ghc_sim_bridge.viewer.layout import alpha_lines
from ghc_sim_bridge.viewer.recording import keep_peaks, position_tasks, write_rerun
from ghc_sim_bridge.viewer.robot import RerunRobot

SCENE = "kuka_lwr"


def entities(path: Path) -> set[str]:
    """Entities of an .rrd file that a viewer can load."""
    rerun = [sys.executable, "-m", "rerun", "rrd"]
    subprocess.run([*rerun, "verify", str(path)], check=True, capture_output=True)
    run = subprocess.run([*rerun, "stats", str(path)], check=True, capture_output=True, text=True)
    return {line.partition(":")[0] for line in run.stdout.splitlines() if line.startswith("/")}


def _log(path: Path, steps: int = 60) -> FullRateLog:
    simulator = Simulator(SCENE)
    buffer = FullRateLogBuffer(simulator.joint_names, ("tool",), simulator.control_dt)
    cycle = ControlCycle(simulator, TorqueGate(simulator.torque_limit, 0.0, 1e-3), None)
    for _ in range(steps):
        torque = cycle.simulator.bias() + 2.0
        q, v = cycle.state.q, cycle.state.v
        cycle.advance(torque)
        buffer.append(
            cycle.time_ns * 1e-9, 0.0, (q, v, v, torque, torque), {"tool": np.ones(6)}, 0, 0
        )
    buffer.save(path)
    return FullRateLog.load(path)


def _series(log: FullRateLog) -> ControllerSeries:
    rng = np.random.default_rng(5)
    time = log.time[::10]
    count = len(time)
    tasks = ("end_effector", "elbow", "posture")
    return ControllerSeries(
        tasks=tasks,
        time=time,
        alpha=rng.uniform(size=(count, 3, 3)),
        error_norms=rng.uniform(size=(count, 3)),
        references={
            name: rng.normal(size=(count, 7 if name == "posture" else 3)) for name in tasks
        },
        errors={name: rng.normal(size=(count, 7 if name == "posture" else 3)) for name in tasks},
    )


def test_recording_shows_arm_targets_alpha_errors_and_torques(tmp_path: Path) -> None:
    log = _log(tmp_path / "log.npz")
    path = tmp_path / "new" / "run.rrd"
    write_rerun(path, log, _series(log), load_scene(SCENE))
    found = entities(path)
    assert {f"/world/robot/joint_{k}" for k in range(1, 8)} <= found
    assert {
        "/plots/alpha", "/plots/task_error", "/plots/torque", "/plots/torque_rate",
        "/plots/contact_force/tool", "/world/targets/end_effector", "/world/targets/elbow",
        "/world/paths/end_effector", "/world/surroundings/floor",
    } <= found  # fmt: skip
    assert "/world/targets/posture" not in found, "joint angles have no place in the world"
    assert [entry.name for entry in path.parent.iterdir()] == ["run.rrd"]


def test_links_are_where_the_simulator_has_them() -> None:
    """Whatever the order of the joints in the log."""
    rng = np.random.default_rng(11)
    simulator = Simulator(SCENE)
    order = rng.permutation(7)
    robot = RerunRobot(simulator.scene.urdf, [simulator.joint_names[k] for k in order])
    angles = rng.uniform(-1.5, 1.5, size=(5, 7))
    placements = robot.placements(angles[:, order])
    for k, q in enumerate(angles):
        simulator.reset(q)
        for joint in range(1, 8):
            translation, quaternion = (v[k] for v in placements[f"world/robot/joint_{joint}"])
            body = simulator.data.body(f"link_{joint}")
            np.testing.assert_allclose(translation, body.xpos, atol=1e-9)
            aligned = abs(float(np.dot(np.roll(quaternion, 1), body.xquat)))  # xyzw -> wxyz
            assert aligned == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("stride", [1, 4, 7])
def test_thinned_rates_keep_every_peak(stride: int) -> None:
    values = np.random.default_rng(stride).normal(size=(101, 3))
    kept = keep_peaks(values, stride)
    assert len(kept) == -(-101 // stride)
    np.testing.assert_array_equal(np.abs(kept).max(axis=0), np.abs(values).max(axis=0))
    for k, row in enumerate(kept):
        window = values[k * stride : (k + 1) * stride]
        for column, value in enumerate(row):
            assert value in window[:, column], "signs are kept and nothing is made up"


def test_alpha_lines_name_every_entry_once() -> None:
    lines = alpha_lines(("a", "b", "c"))
    assert sorted((i, j) for _, i, j in lines) == [(i, j) for i in range(3) for j in range(3)]
    names = {(i, j): name for name, i, j in lines}
    assert names[1, 0] == "a > b", "alpha[b, a] = 1: a is strictly above b"
    assert names[2, 2] == "c off"


def test_a_target_in_space_has_three_coordinates(tmp_path: Path) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text(
        "tasks: [{name: all, kind: frame_position}, {name: some, kind: frame_position, "
        "axes: [x, z]}, {name: mass, kind: center_of_mass, axes: [x, y, z]}, "
        "{name: rest, kind: posture}]"
    )
    assert position_tasks(robot) == ("all", "mass")


def test_files_that_cannot_be_read_are_one_clear_error(tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text("tasks: 3")
    for path in (tmp_path / "nowhere.yaml", other):
        with pytest.raises(ConfigurationError, match=path.stem):
            position_tasks(path)
    for path in (tmp_path / "nowhere.mcap", other):
        with pytest.raises(ConfigurationError, match=path.stem):
            ControllerSeries.from_recording(path)

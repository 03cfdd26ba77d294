"""One control period of the bridge without ROS, and the log that remains of it."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError
from ghc_controller.safety.torque_gate import TorqueGate
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.logs.full_rate_log import BLOCK_ROWS, FullRateLog, FullRateLogBuffer, Source
from ghc_sim_bridge.simulation.simulator import Simulator

SCENE = "kuka_lwr"


def _cycle(rate: float = 0.0) -> tuple[ControlCycle, FullRateLogBuffer]:
    simulator = Simulator(SCENE)
    log = FullRateLogBuffer(simulator.joint_names, tuple(simulator.contact_wrenches()), 1e-3)
    return ControlCycle(simulator, TorqueGate(simulator.torque_limit, rate, 1e-3), log), log


def test_held_from_the_start_the_arm_does_not_move() -> None:
    cycle, _ = _cycle()
    start = cycle.state.q.copy()
    for _ in range(200):
        cycle.advance(None)
    assert np.abs(cycle.state.q - start).max() < 1e-9
    assert cycle.time_ns == 200_000_000


def test_hold_brings_a_moving_arm_to_rest_within_the_rate_limit() -> None:
    cycle, log = _cycle(rate=1000.0)
    for _ in range(150):
        cycle.advance(cycle.simulator.bias() + 3.0)
    assert np.abs(cycle.state.v).max() > 0.5
    for _ in range(1000):
        cycle.advance(None)
    assert np.abs(cycle.state.v).max() < 1e-3
    torque = log.columns()["torque"]
    assert np.abs(np.diff(torque, axis=0)).max() <= 1.0 + 1e-9


def test_log_rows_are_states_with_the_torque_applied_from_there(tmp_path: Path) -> None:
    cycle, buffer = _cycle()
    limit = cycle.simulator.torque_limit
    cycle.advance(None)
    for scale in (0.5, 2.0):
        cycle.advance(scale * limit)
    buffer.save(tmp_path / "new" / "log.npz")
    log = FullRateLog.load(tmp_path / "new" / "log.npz")
    assert log.joint_names == cycle.simulator.joint_names
    assert log.control_dt == 1e-3
    np.testing.assert_allclose(log.time, [0.0, 1e-3, 2e-3], atol=1e-15)
    assert log.source.tolist() == [Source.HOLD, Source.COMMAND, Source.GATED]
    assert np.isnan(log.commanded[0]).all()
    np.testing.assert_array_equal(log.commanded[2], 2.0 * limit)
    np.testing.assert_array_equal(log.torque[2], limit)
    np.testing.assert_allclose(log.v[1:], log.v[:-1] + 1e-3 * log.acceleration[:-1], atol=1e-9)
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["log.npz"]


def test_log_grows_without_losing_rows() -> None:
    buffer = FullRateLogBuffer(["a"], ["tool"], 1e-3)
    rows = BLOCK_ROWS + 3
    for k in range(rows):
        vector = np.array([float(k)])
        buffer.append(k * 1e-3, 0.0, (vector,) * 5, {"tool": np.full(6, k)}, Source.COMMAND, k % 7)
    columns = buffer.columns()
    np.testing.assert_array_equal(columns["q"][:, 0], np.arange(rows))
    np.testing.assert_array_equal(columns["wrench_tool"][:, 5], np.arange(rows))
    np.testing.assert_array_equal(columns["epoch"], np.arange(rows) % 7)


def test_no_row_of_a_long_log_costs_more_than_a_block() -> None:
    """A copy of all rows would take several control periods."""
    buffer = FullRateLogBuffer(["a"], [], 1e-3)
    vector = np.zeros(1)
    tracemalloc.start()
    try:
        peaks = []
        for _ in range(20 * BLOCK_ROWS + 1):
            held = tracemalloc.get_traced_memory()[0]
            tracemalloc.reset_peak()
            buffer.append(0.0, 0.0, (vector,) * 5, {}, Source.COMMAND, 0)
            peaks.append(tracemalloc.get_traced_memory()[1] - held)
    finally:
        tracemalloc.stop()
    block = BLOCK_ROWS * 8 * (2 + 5 + 1)
    assert block < max(peaks) < 1.5 * block


def test_a_reset_begins_the_next_epoch_at_a_whole_second_to_come() -> None:
    """More than a second later, so that no reader takes its states for those of the run before."""
    cycle, _ = _cycle()
    start = cycle.state.q.copy()
    for _ in range(20):
        cycle.advance(cycle.simulator.bias() + 2.0)
    cycle.reset()
    assert (cycle.time_ns, cycle.run_ns, cycle.epoch) == (2 * NANOSECONDS, 0, 1)
    cycle.reset()
    assert (cycle.time_ns, cycle.run_ns, cycle.epoch) == (4 * NANOSECONDS, 0, 2)
    cycle.advance(None)
    assert cycle.time_ns == cycle.start_ns + cycle.period_ns
    np.testing.assert_array_equal(cycle.state.q, start)


def test_log_that_is_missing_or_something_else_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="nowhere"):
        FullRateLog.load(tmp_path / "nowhere.npz")
    np.savez(tmp_path / "other.npz", x=1)
    with pytest.raises(ConfigurationError, match="other"):
        FullRateLog.load(tmp_path / "other.npz")


def test_a_command_continues_within_two_periods_of_the_rate_limit() -> None:
    """Joint by joint, to both sides; anything does where the rate is not limited."""
    cycle, _ = _cycle(rate=1000.0)
    cycle.advance(None)
    applied, limit = cycle.simulator.torque, cycle.simulator.torque_limit
    assert cycle.continues(applied)
    for side in (-1.0, 1.0):
        for joint in np.eye(len(limit)):
            assert cycle.continues(applied + 1.999 * side * joint)
            assert not cycle.continues(applied + 2.001 * side * joint)
    assert not cycle.continues(np.full(len(limit), 1e300))
    assert _cycle(rate=0.0)[0].continues(np.full(len(limit), 1e300))

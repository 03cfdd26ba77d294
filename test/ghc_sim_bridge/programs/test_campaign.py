"""The status on disturbed runs: who is up, who fell, and the count of both."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ghc_sim_bridge.analysis.campaign_status import RunStatus, campaign_table, judge, tally
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.programs.campaign import disturbed_plan

DT = 0.01


def log_with_base(height: float, tilt: float) -> FullRateLog:
    """Two rows at rest, the base turned about y and then by half a turn about z."""
    zeros = np.zeros((2, 1))
    half = 0.5 * tilt
    pose = np.array([0.0, 0.0, height, np.sin(half), 0.0, np.cos(half), 0.0])
    return FullRateLog(
        time=np.array([0.0, DT]),
        q=zeros,
        v=zeros,
        acceleration=zeros,
        torque=np.array([[0.0], [2.0]]),
        commanded=zeros,
        source=np.zeros(2, np.uint8),
        epoch=np.zeros(2, np.uint32),
        cycle_time=np.zeros(2),
        joint_names=("a",),
        wrenches={},
        control_dt=DT,
        base_pose=np.stack([pose, pose]),
        base_velocity=np.zeros((2, 6)),
    )


@pytest.mark.parametrize(
    ("height", "tilt", "up"),
    [(0.6, 0.0, True), (0.5, 0.2, True), (0.4, 0.0, False), (0.6, 0.5, False), (0.1, 1.5, False)],
)
def test_up_is_high_and_level(height: float, tilt: float, up: bool) -> None:
    status = judge(RunStatus("s", True, 0), log_with_base(height, tilt), 0.6)
    assert status.stays_up is up
    assert status.tilt == pytest.approx(tilt, abs=1e-9)
    assert status.peak_torque_rate == pytest.approx(2.0 / DT)


def test_totals_count_per_scenario_and_side() -> None:
    runs_done = [
        RunStatus("a", False, 0, stays_up=True),
        RunStatus("a", True, 0, stays_up=True),
        RunStatus("a", False, 1, fallback_ticks=3),
        RunStatus("a", True, 1, stays_up=True),
    ]
    off, on = tally(runs_done)
    assert (off.runs, off.stay_up, off.fallen_seeds) == (2, 1, (1,))
    assert (on.runs, on.stay_up, on.fallen_seeds) == (2, 2, ())
    assert (off.fallback_ticks, on.fallback_ticks) == (3, 0)
    assert "1 of 2" in campaign_table((off, on))


def test_the_seed_reaches_the_bridge_and_both_sides_have_folders_of_their_own(
    tmp_path: Path,
) -> None:
    plans = [disturbed_plan("force_bound_step", side, 3, tmp_path) for side in (False, True)]
    assert all(plan.parameters["sim_bridge"]["disturbance_seed"] == 3 for plan in plans)
    assert plans[0].folder != plans[1].folder

"""Aggressive closed loops with the torque rate limit on: position and velocity limits hold."""

from __future__ import annotations

import pytest

from benchmarks.studies.transitions.aggressive_loop import ARMS, STIFF, STIFFER
from benchmarks.targets.limit_loop import Loop, run_loop


@pytest.mark.parametrize(
    ("loop", "seed", "duration", "step"),
    [
        (STIFF, 5, 2.0, 1.0),
        (STIFFER, 1, 2.0, 0.5),
        (STIFFER, 5, 2.0, 0.5),
        (ARMS, 0, 0.6, 1.0),
    ],
    ids=lambda value: getattr(value, "robot", str(value)),
)
def test_limits_hold_under_aggressive_changes(
    loop: Loop, seed: int, duration: float, step: float
) -> None:
    """Goals of the study, in its first seconds; no torque step beyond the rate limit."""
    row = run_loop(loop, "cascade", seed, duration)
    ticks = sum(row["status"].values())
    assert ticks == round(1e3 * duration)
    assert row["ended_at_s"] is None
    assert row["position_excess_rad"] <= 1e-4
    assert row["velocity_excess_percent"] <= 1.0
    assert row["torque_excess_nm"] <= 1e-9
    assert row["largest_torque_step_nm"] <= step * (1.0 + 1e-9)
    assert row["status"]["RELAXED"] <= 1e-3 * ticks
    assert row["status"]["FALLBACK"] == 0
    assert row["rate_gave_way"] == 0


def test_without_the_planned_jerk_the_same_loop_breaks_its_speed_limits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The loop is aggressive enough to tell: more than fivefold speed, 0.07 rad too far."""
    monkeypatch.setattr("ghc_controller.settings.PlannedJerk", lambda *_: None)
    row = run_loop(STIFFER, "cascade", 1, 2.0)
    assert row["velocity_excess_percent"] > 50.0
    assert row["position_excess_rad"] > 1e-3
    assert row["status"]["RELAXED"] > 100

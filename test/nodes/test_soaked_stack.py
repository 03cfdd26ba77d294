"""The whole stack in lockstep under random inputs; the controller is killed in motion."""

from __future__ import annotations

from pathlib import Path

from benchmarks.soak.stack import Life, soak_stack


def test_kills_in_motion_end_nothing_and_every_state_is_recorded(
    ros_domain_id: int, tmp_path: Path
) -> None:
    """A controller that starts again in motion is followed, although its first torque jumps."""
    figures = soak_stack(tmp_path, length=8.0, warm_up=2.0, kill_every=3.0)
    assert figures["kills"] == 2
    assert figures["lives"][-1]["node"] != "sim_bridge"
    assert {life["node"] for life in figures["lives"]} >= {"controller", "recorder", "sim_bridge"}
    assert (figures["ticks"], figures["ticks_missing"]) == (1601, 0)
    assert figures["recorder_exit"] == 0


def test_growth_is_counted_after_the_warm_up() -> None:
    life = Life("node", [float(t) for t in range(0, 400, 5)], [])
    life.resident = [100.0 + min(t, 100.0) + 2.0 * t / 3600.0 for t in life.times]
    growth = life.growth(100.0)
    assert growth is not None
    assert abs(growth - 2.0) < 1e-6
    assert Life("short", [0.0, 50.0], [1.0, 2.0]).growth(20.0) is None

"""`new_robot`, then a swap over DDS with default settings, on robots of example-robot-data."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.users.new_robots import MODELS, run

pytestmark = [pytest.mark.long, pytest.mark.timeout(1800)]

MET, AT_REST = 1e-3, 1e-3  # [m] or [rad], [rad/s]


@pytest.mark.parametrize("name", MODELS)
def test_a_new_robot_swaps_two_priorities(name: str, tmp_path: Path) -> None:
    """Targets by seed; first task and mean joint speed at the end of each phase."""
    phases = run(name, tmp_path, seed=0)
    assert len(phases) == 3
    for phase in phases:
        assert phase.first <= MET, phase
        assert phase.speed <= AT_REST, phase

"""From a URDF to a swap over DDS: `new_robot` and `experiment` as processes, nothing edited."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ghc_controller.robot.library import find_robot

pytestmark = pytest.mark.timeout(400)


def test_a_robot_that_nobody_here_has_seen_swaps_two_tasks(
    start_node: Callable[..., Any], tmp_path: Path
) -> None:
    """The arm's first joint is continuous; first task within 1 mm at the end of each phase."""
    text = next(find_robot("kuka_lwr").parent.glob("*.urdf")).read_text(encoding="utf-8")
    urdf = tmp_path / "turner.urdf"
    urdf.write_text(text.replace('type="revolute"', 'type="continuous"', 1), encoding="utf-8")
    made = start_node("ghc_controller", "new_robot", urdf, "--folder", tmp_path / "turner")
    assert made.wait(120.0) == 0, made.output
    run = start_node(
        "ghc_sim_bridge",
        "experiment",
        "--scenario",
        tmp_path / "turner/swap.yaml",
        "--output",
        tmp_path / "results",
    )
    assert run.wait(300.0) == 0, run.output
    file = next((tmp_path / "results").rglob("summary.json"))
    summary = json.loads(file.read_text(encoding="utf-8"))
    assert len(summary["phases"]) == 3
    for phase in summary["phases"]:
        first = phase["hierarchy"].partition(" > ")[0]
        assert phase["errors"][first] <= 1e-3

"""`experiment` with constraint generators end to end, on short scenarios."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from ghc_sim_bridge.logs.constraint_series import ConstraintSeries
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scenario.scenario import find_scenario
from ghc_sim_bridge.scene.description import find_scene

pytestmark = pytest.mark.timeout(700)

JUMP, GONE, DURATION = 0.3, 0.8, 1.2  # [s]


def _short_jump(folder: Path, **changes: object) -> Path:
    """The obstacle scenario with one jump of 5 cm, soon after the start."""
    scene = yaml.safe_load(find_scene("kuka_lwr_obstacle").read_text(encoding="utf-8"))
    track = [{"time": JUMP, "position": [0.70, 0.0, 0.5]}, {"time": GONE}]
    scene["obstacles"][0]["track"] = track
    (folder / "scene.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    scenario = yaml.safe_load(find_scenario("obstacle_jump").read_text(encoding="utf-8"))
    scenario |= {
        "name": "short",
        "scene": str(folder / "scene.yaml"),
        "hold": DURATION,
        "references": {},
        "generators": {"obstacle_bounds": {"margin": 0.1, "max_velocity": 0.5, "horizon": 0.5}},
        "events": [{"time": JUMP, "name": "jumps in"}, {"time": GONE, "name": "is gone"}],
    }
    return _written(folder, scenario | changes)


def _written(folder: Path, scenario: dict[str, Any]) -> Path:
    file = folder / "short.yaml"
    file.write_text(yaml.safe_dump(scenario), encoding="utf-8")
    return file


def _run(start_node: Callable[..., Any], folder: Path, file: Path, *options: str) -> Any:
    output = ("--output", folder / "results")
    node = start_node("ghc_sim_bridge", "experiment", "--scenario", file, *output, *options)
    node.wait(300.0)
    return node


def test_a_scenario_with_generators_runs_without_and_with_them_and_compares(
    start_node: Callable[..., Any], tmp_path: Path
) -> None:
    node = _run(start_node, tmp_path, _short_jump(tmp_path))
    assert node.exit_code == 0, node.output
    results = tmp_path / "results" / "short"
    data = json.loads((results / "comparison.json").read_text(encoding="utf-8"))
    assert (results / "generators.png").is_file()
    assert [event["name"] for event in data["events"]] == ["jumps in", "is gone"]
    jump = data["events"][0]
    assert jump["ratio"] > 10.0
    assert "jumps in" in node.output and "inside the safe distance" in node.output
    for side in ("off", "on"):
        assert data["obstacles"]["wall"][side]["qp_violation_m"] < 1e-4
    summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
    assert summary["variant"] == "cascade-generators_on", "the default variant"
    assert set(summary["nodes"].values()) == {0}
    assert "obstacle_bounds" in summary["nodes"]
    series = ConstraintSeries.load(results / "cascade-generators_off" / "constraints.npz")
    present = np.isfinite(series.obstacles["wall"][:, 0])
    seen = series.time[present]
    assert seen[0] == pytest.approx(JUMP) and seen[-1] == pytest.approx(GONE - 0.01)


def test_runs_with_generators_are_repeatable(
    start_node: Callable[..., Any], tmp_path: Path
) -> None:
    file = _short_jump(tmp_path)
    logs = []
    for _ in range(2):
        node = _run(start_node, tmp_path, file, "--generators", "on")
        assert node.exit_code == 0, node.output
        folder = tmp_path / "results" / "short" / "cascade-generators_on"
        logs.append(FullRateLog.load(folder / "log.npz"))
    np.testing.assert_allclose(logs[0].torque, logs[1].torque, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(logs[0].q, logs[1].q, rtol=0.0, atol=1e-9)


def test_a_refused_schedule_ends_the_run_with_the_generators_reason(
    start_node: Callable[..., Any], tmp_path: Path
) -> None:
    scenario = yaml.safe_load(find_scenario("force_bound_step").read_text(encoding="utf-8"))
    scenario["generators"]["contact_force_bounds"]["contacts"] = ["hand"]
    node = _run(start_node, tmp_path, _written(tmp_path, scenario))
    assert node.exit_code == 1
    assert "contact_force_bounds rejected a schedule" in node.output
    assert "unknown contact 'tool'; known: hand" in node.output
    assert "Traceback" not in node.output


def test_the_choice_of_generators_needs_some(
    start_node: Callable[..., Any], tmp_path: Path
) -> None:
    node = _run(start_node, tmp_path, Path("priority_switching"), "--generators", "off")
    assert node.exit_code == 2
    assert "scenario 'priority_switching' has no section 'generators'" in node.output

"""The comparison with tsid and placo: its files, our side of it, its table."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from benchmarks.peers.own_side import OwnSide
from benchmarks.peers.problem import DT, PeerProblem
from benchmarks.peers.report import peers_table, ratio, write_page
from benchmarks.peers.robots import peer_robot
from benchmarks.peers.session import STATES
from tools.lock import PEERS
from tools.workspace.checks import SUPPORTED
from tools.workspace.layout import Layout

ROOT = Path(__file__).resolve().parents[2]
CASES = sorted(path.stem for path in STATES.glob("*.npz"))


def test_every_robot_has_cases_with_and_without_active_bounds() -> None:
    assert len(CASES) == 15
    for robot in ("kuka_lwr", "icub"):
        assert {f"{robot}_5_free", f"{robot}_5_bounds"} <= set(CASES)
    assert "icub_standing_5" in CASES


@pytest.mark.parametrize("case", CASES)
def test_a_case_is_the_same_after_it_was_written(case: str, tmp_path: Path) -> None:
    problem = PeerProblem.load(STATES / f"{case}.npz")
    problem.save(tmp_path / "again.npz")
    again = PeerProblem.load(tmp_path / "again.npz")
    assert (again.tasks, again.contacts, again.joints) == (
        problem.tasks,
        problem.contacts,
        problem.joints,
    )
    assert np.array_equal(again.q, problem.q) and np.array_equal(again.v, problem.v)
    assert again.goals.keys() == problem.goals.keys()
    assert problem.begins(0) and sum(map(problem.begins, range(len(problem.q)))) == 4
    assert [problem.weight(k) for k in range(2)] != [1.0, 1.0] or len(problem.tasks) == 1


@pytest.mark.parametrize(
    ("case", "reached"), [("kuka_lwr_3_bounds", True), ("kuka_lwr_3_free", False)]
)
def test_our_side_answers_inside_the_limits_that_all_sides_have(case: str, reached: bool) -> None:
    problem = PeerProblem.load(STATES / f"{case}.npz")
    side = OwnSide(problem, "", "cascade", "strict")
    side.enter(0)
    torques = np.array([side.watch(row) for row in range(25)])
    beyond = np.abs(torques) / problem.torque_limit
    assert beyond.max() <= 1.0 + 1e-9
    assert bool(beyond.max() > 1.0 - 1e-6) is reached
    assert bool(side.facts()["qps"] > 0.0) is reached


def test_our_side_is_the_product_controller() -> None:
    problem = PeerProblem.load(STATES / "kuka_lwr_3_bounds.npz")
    side = OwnSide(problem, "", "balanced", "strict")
    side.enter(0)
    torque = side.step(0)
    robot = peer_robot("kuka_lwr", 3)
    robot.model.limits = replace(robot.model.limits, torque=problem.torque_limit)
    settings = ghc.Settings(formulation="balanced", control_dt=DT, torque_rate_limit=0.0)
    controller = ghc.Controller(robot, settings)
    state = ghc.RobotState(0.0, problem.q[0], problem.v[0])
    controller.start(state)
    for name, goals in problem.goals.items():
        controller.set_reference(name, goals[0])
    assert np.array_equal(controller.step(state).torque, np.asarray(torque))


def test_in_a_ramp_two_orders_are_in_force() -> None:
    problem = PeerProblem.load(STATES / "kuka_lwr_3_free.npz")
    for order in ("strict", "ramp"):
        side = OwnSide(problem, "", "cascade", order)
        side.enter(0)
        assert side.step(0) is not None and side.step(1) is not None
        priorities = side.controller.problem().priorities
        assert len(priorities.candidates) == (2 if order == "ramp" else 1)


def made_up(case: str, ours: float, tsid: float, placo: float) -> dict[str, Any]:
    """A row with medians [us]."""
    times = {"cascade": ours, "balanced": ours, "ghc": ours, "tsid": tsid, "placo": placo}
    row: dict[str, Any] = {name: {"p50_us": t, "p99_us": 2.0 * t} for name, t in times.items()}
    row["cascade"] |= {"qps": 1.5, "pivots": 2.0}
    return {"case": case, **row}


def test_the_ratio_is_to_the_faster_peer_and_the_page_names_versions(tmp_path: Path) -> None:
    rows = [made_up("a", 10.0, 40.0, 20.0), made_up("b", 30.0, 20.0, 60.0)]
    assert [ratio(row) for row in rows] == [0.5, 1.5]
    assert "| a | 10.0 (20) |" in peers_table(rows) and "| 0.50 | 1.5, 2.0 |" in peers_table(rows)
    (tmp_path / "figures").mkdir()
    results = {
        "rows": rows,
        "machine": {"cpu": "x", "cores": 2},
        "load_average": {"before": 0.1},
        "peers": {"tsid": "1.2.3", "placo": "4.5.6"},
    }
    write_page(results, tmp_path)
    text = (tmp_path / "peers.md").read_text(encoding="utf-8")
    assert "tsid 1.2.3 and placo\n4.5.6" in text and "{" not in text
    assert (tmp_path / "figures" / "peers.png").stat().st_size > 0
    assert json.loads(json.dumps(results)) == results


def test_each_peer_has_a_lock_with_hashes_for_every_python() -> None:
    for version in SUPPORTED:
        for peer in PEERS:
            text = Layout(ROOT).peer_lock(peer, version).read_text(encoding="utf-8")
            assert f"\n{peer}==" in text and "--hash=sha256:" in text

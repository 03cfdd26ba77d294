"""The benchmark runs, and its results have the parts that readers expect; no speed is judged."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import ControllerState
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from benchmarks.loops import loop_generators
from benchmarks.loops.loop_bench import CASES, LoopCase, run_loop_bench
from benchmarks.previews.mpc_bench import COUNTS, HORIZONS, KINDS
from benchmarks.previews.mpc_loads import LOADS
from benchmarks.previews.mpc_report import generators_of, mpc_table
from benchmarks.run import main
from benchmarks.steps.document import write_document
from benchmarks.steps.goals import check_goals, ratios
from benchmarks.steps.pace import Pace
from benchmarks.steps.step_bench import REGIMES, VARIANTS
from benchmarks.steps.tables import loop_table
from benchmarks.steps.timed_controller import PARTS
from ghc_controller.ros.qos import STREAM_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_sim_bridge.logs.full_rate_log import FullRateLog, Source

pytestmark = pytest.mark.timeout(600)  # [s]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Output of a quick run on the robot that needs no further package."""
    folder = tmp_path_factory.mktemp("bench")
    arguments = ["--quick", "--only", "step", "--robot", "kuka_lwr", "--output", str(folder)]
    assert main(arguments) == 0
    return folder


@pytest.fixture(scope="module")
def results(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "bench.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def tick_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Output of a quick run over the generators' ticks."""
    folder = tmp_path_factory.mktemp("ticks")
    assert main(["--quick", "--only", "mpc", "--output", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def ticks(tick_folder: Path) -> list[dict[str, Any]]:
    results = json.loads((tick_folder / "bench.json").read_text(encoding="utf-8"))
    assert results["step"] == results["loop"] == []
    assert results["goals"] == check_goals([], [], results["mpc"])
    return results["mpc"]


def _loop_rows() -> list[dict[str, Any]]:
    figures = {"steps_per_second": 1500.0, "real_time_factor": 1.1}
    figures |= {"cycle_p50_us": 600.0, "cycle_p99_us": 900.0, "taken_by_host": 0.1}
    figures |= {"calmest_real_time_factor": 1.3, "least_taken_by_host": 0.02}
    return [{"executor": c.executor, "generators": c.generators} | figures for c in CASES]


def test_every_case_is_measured_once(results: dict[str, Any]) -> None:
    keys = ("tasks", "regime", "formulation", "solver")
    cases = [tuple(row[key] for key in keys) for row in results["step"]]
    expected = {
        (tasks, regime, variant.formulation, variant.solver)
        for tasks in range(1, 6)
        for regime in REGIMES
        for variant in VARIANTS
    }
    assert len(cases) == len(expected)
    assert set(cases) == expected


def test_the_regimes_are_what_they_are_called(results: dict[str, Any]) -> None:
    for row in results["step"]:
        if row["regime"] == "inactive":
            assert row["active_bounds"] == 0.0
            assert row["qp_share"] == (1.0 if row["formulation"] == "ghc_full" else 0.0)
            assert row["qps"] == row["qp_share"]
            assert row["pivots"] >= row["qps"]
        else:
            assert row["qp_share"] > 0.5
            assert row["pivots"] >= row["qps"] >= row["qp_share"]
            if row["solver"] == "daqp":  # exact: active to the last digit
                assert row["active_bounds"] > 0.5
        assert row["solved_share"] > 0.9


def test_times_are_complete(results: dict[str, Any]) -> None:
    for row in results["step"]:
        assert row["steps"] == results["settings"]["steps"]
        assert 0.0 < row["median_us"] <= row["p99_us"]
        assert set(row["parts_us"]) == set(PARTS)
        assert row["parts_us"]["terms"] > 0.0 and row["parts_us"]["solve"] > 0.0


def test_ratios_and_goals_follow_from_the_rows(results: dict[str, Any]) -> None:
    assert results["ratios"] == ratios(results["step"])
    assert len(results["ratios"]) == 5 * len(REGIMES) * 2  # two solvers
    assert results["goals"] == check_goals(results["step"], [])
    assert {goal["met"] for goal in results["goals"]} <= {True, False}
    (ratio,) = (goal for goal in results["goals"] if "cascade over balanced" in goal["goal"])
    medians = {
        row["formulation"]: row["median_us"]
        for row in results["step"]
        if (row["tasks"], row["regime"], row["solver"]) == (5, "inactive", "daqp")
    }
    expected = medians["cascade"] / medians["balanced"]
    assert ratio["measured"] == pytest.approx(expected, abs=0.01)
    assert ratio["limit"] == 1.5


def test_facts_name_no_machine_and_no_folder(folder: Path, results: dict[str, Any]) -> None:
    text = (folder / "bench.json").read_text(encoding="utf-8")
    assert set(results["machine"]) == {"cpu", "cores", "system", "python", "versions", "commit"}
    assert Path("/etc/hostname").read_text(encoding="utf-8").strip() not in text
    assert str(Path.home()) not in text
    assert str(folder) not in text


def test_the_document_is_made_from_the_results(
    results: dict[str, Any], ticks: list[dict[str, Any]], tmp_path: Path
) -> None:
    loop = _loop_rows()
    write_document(results | {"loop": loop, "mpc": ticks}, tmp_path)
    text = (tmp_path / "benchmarks.md").read_text(encoding="utf-8")
    assert loop_table(loop) in text
    assert all(mpc_table(ticks, generator) in text for generator in generators_of(ticks))
    assert all(goal["goal"] in text for goal in results["goals"])
    assert "{" not in text  # nothing was left to be filled in


def test_the_plots_are_small_files(folder: Path, tick_folder: Path) -> None:
    for path in (folder / "step_time.png", tick_folder / "tick_time.png"):
        assert 5_000 < path.stat().st_size < 150_000


def test_every_generator_is_timed_while_all_that_it_plans_changes(
    ticks: list[dict[str, Any]],
) -> None:
    cases = {(row["generator"], row["count"], row["horizon"]) for row in ticks}
    assert cases == {(load.generator, n, h) for load in LOADS for n in COUNTS for h in HORIZONS}
    assert len(ticks) == len(cases)
    for row in ticks:
        assert row["moving_share"] == 1.0, row
        assert row["second_opinions"] == 0
        assert set(row["ticks_us"]) == set(KINDS)
        for times in row["ticks_us"].values():
            assert times["ticks"] > 0
            assert 0.0 < times["median"] <= times["p99"]


def test_goals_of_ticks_and_loops() -> None:
    """Two for each generator, at 4 and 1.5 s; two for each loop with the fast executor."""
    times = {kind: {"median": 100.0} for kind in KINDS} | {"changed": {"median": 2100.0}}
    rows = [
        {"generator": "g", "handles": "contacts", "count": n, "horizon": h, "ticks_us": times}
        for n in COUNTS
        for h in HORIZONS
    ]
    goals = check_goals([], _loop_rows(), rows)
    assert [goal["limit"] for goal in goals] == [1.2, 1.2, 1.0, 1.0, 2000.0, 2000.0]
    assert [goal["met"] for goal in goals] == [False, True, True, True, True, False]
    assert all("4 contacts, N T = 1.5 s" in goal["goal"] for goal in goals[4:])


def test_the_loop_with_generators_uses_their_plans(ros_context: Any, tmp_path: Path) -> None:
    """1.3 s at 1 kHz, the wall inside since 1 s: contact and obstacle are in the controller."""
    node = Node("reader", context=ros_context)
    states: list[ControllerState] = []
    node.create_subscription(ControllerState, "ghc/controller_state", states.append, STREAM_QOS)
    case = LoopCase("events", generators=True)
    (row,) = run_loop_bench(tmp_path, 0.8, 1, Pace(), lambda _: None, [case])
    assert row["steps"] == 800
    assert row["generators"]
    assert row["calmest_real_time_factor"] == row["real_time_factor"]  # of the only run
    assert 0.0 <= row["least_taken_by_host"] == row["taken_by_host"] < 1.0
    executor = SingleThreadedExecutor(context=ros_context)
    executor.add_node(node)
    for _ in range(20):  # what came last is still there to be read
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    node.destroy_node()
    assert [c.name for c in states[-1].contacts if c.planned] == ["tool"]
    generator = ContactForceBounds(ForceBoundSettings())
    generator.observe(loop_generators.schedule(), 0.0)  # known before time runs
    ticks = round(nanoseconds_from_time(states[-1].header.stamp) / 1e7)
    assert 100 < ticks <= 130
    plans = [generator.tick(0.01 * k) for k in range(ticks + 1)]
    assert states[-1].contacts[0].upper == pytest.approx(plans[-1].upper[0, 0], rel=1e-9)
    assert 20.0 <= states[-1].contacts[0].upper < 60.0
    assert [obstacle.id for obstacle in states[-1].obstacles] == ["wall"]
    assert states[-1].obstacles[0].position[1] < 0.4
    log = FullRateLog.load(tmp_path / "events_generators" / "log.npz")
    assert set(log.source) == {Source.COMMAND}
    assert np.abs(log.v).max() < 3.0


def test_the_schedule_of_the_loop_outlasts_it_and_keeps_its_contact() -> None:
    schedule = loop_generators.schedule()
    assert schedule.times[-1] > 20.0
    assert schedule.upper.min() > 0.0


@pytest.mark.long
def test_the_loops_in_real_time_and_lockstep_are_counted_beside_bare_ones(tmp_path: Path) -> None:
    assert main(["--quick", "--only", "realtime", "--output", str(tmp_path)]) == 0
    found = json.loads((tmp_path / "realtime.json").read_text(encoding="utf-8"))
    assert found["lockstep_ratio"] > 1.0
    assert all(0.0 <= found[name] <= 100.0 for name in ("lost_percent", "bare_lost_percent"))


def test_the_slowest_of_many_steps_are_found(tmp_path: Path) -> None:
    """In every case, in order of the percentiles, by the clock and by processor time."""
    assert main(["--quick", "--only", "tails", "--output", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "tails.json").read_text(encoding="utf-8"))["rows"]
    assert len(rows) == 5
    for row in rows:
        assert row["steps"] >= 500
        for kind in ("cpu", "wall"):
            times = [
                value for name, value in row.items() if name.startswith(kind) and "us" in name
            ]
            assert 0.0 < times[0] < times[-1]
            assert times == sorted(times)


def test_wrong_options_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--only", "everything"])
    assert "step" in capsys.readouterr().err


def test_the_standing_humanoid_is_timed_with_its_feet_in_contact(tmp_path: Path) -> None:
    assert main(["--quick", "--only", "standing", "--output", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "bench.json").read_text(encoding="utf-8"))["standing"]
    assert {row["tasks"] for row in rows} == {1, 2, 3, 4, 5}
    assert all(row["solved_share"] == 1.0 for row in rows)
    for row in rows:  # a cascade needs no QP where no bound is reached
        assert row["qps"] >= row["qp_share"]
        assert row["formulation"] in ("cascade", "hqp") or row["qp_share"] == 1.0

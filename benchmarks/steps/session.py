"""One session: measure, print, write."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.loops.loop_bench import run_loop_bench
from benchmarks.machine import load_average, machine_facts
from benchmarks.previews.mpc_bench import FULL as MPC_FULL
from benchmarks.previews.mpc_bench import QUICK as MPC_QUICK
from benchmarks.previews.mpc_bench import run_mpc_bench
from benchmarks.previews.mpc_report import generators_of, mpc_table, plot_ticks
from benchmarks.previews.mpc_section import TICK_FIGURE
from benchmarks.steps.document import FIGURE, write_document
from benchmarks.steps.figure import plot_step_times
from benchmarks.steps.goals import check_goals, ratios
from benchmarks.steps.pace import Pace
from benchmarks.steps.robots import Arm, BenchRobot, Humanoid
from benchmarks.steps.standing_bench import TITLE as STANDING
from benchmarks.steps.standing_bench import run_standing_bench, standing_table
from benchmarks.steps.states import TORQUE_SHARE
from benchmarks.steps.step_bench import FULL, QUICK, REGIMES, run_step_bench
from benchmarks.steps.tables import REGIME_TITLES, goal_table, loop_table, robots_of, step_table
from ghc_controller.report.valid_json import json_text
from tools.workspace.layout import Layout

_LOOP = (4.0, 6)  # [s] simulated per run, runs per executor
_QUICK_LOOP = (1.0, 1)
_STANDING = (5, 40, 5)  # segments, steps in each, rounds
_QUICK_STANDING = (1, 10, 1)


def run_session(options: argparse.Namespace, root: Path) -> dict[str, Any]:
    """Measure what the options ask for and write it; the content of bench.json."""
    effort = QUICK if options.quick else FULL
    robots = _robots(options.robot, root) if options.only in (None, "step") else []
    before, pace = load_average(), Pace()
    pace.take()
    step = list(run_step_bench(robots, effort, pace, _tell))
    standing: list[dict[str, Any]] = []
    if options.only in (None, "standing"):
        amount = _QUICK_STANDING if options.quick else _STANDING
        standing = list(run_standing_bench(Layout(root), *amount, pace, _tell))
    duration, rounds = _QUICK_LOOP if options.quick else _LOOP
    mpc: list[dict[str, Any]] = []
    if options.only in (None, "mpc"):
        mpc = list(run_mpc_bench(MPC_QUICK if options.quick else MPC_FULL, pace, _tell))
    loop: list[dict[str, Any]] = []
    if options.only in (None, "loop"):
        loop = list(run_loop_bench(options.output / "loop", duration, rounds, pace, _tell))
    results: dict[str, Any] = {
        "machine": machine_facts(),
        "load_average": {"before": before, "after": load_average()},
        "pace": pace.summary(),
        "settings": {
            "quick": options.quick,
            "steps": effort.steps,
            "segment_length": effort.length,
            "torque_share": TORQUE_SHARE,
        },
        "titles": {robot.name: robot.title for robot in robots},
        "step": step,
        "ratios": ratios(step),
        "standing": standing,
        "mpc": mpc,
        "loop": loop,
        "goals": check_goals(step, loop, mpc, standing),
    }
    _print(results)
    _write(results, options.output)
    if options.write_docs:
        docs = root / "docs"
        _plot(results, docs / "figures")
        write_document(results, docs)
    return results


def _robots(name: str | None, root: Path) -> Sequence[BenchRobot]:
    robots: list[BenchRobot] = []
    if name in (None, Arm.name):
        robots.append(Arm())
    if name in (None, Humanoid.name):
        robots.append(Humanoid(Layout(root)))
    return robots


def _tell(text: str) -> None:
    print(f"bench: {text}", file=sys.stderr, flush=True)


def _print(results: dict[str, Any]) -> None:
    step, loop = results["step"], results["loop"]
    for robot in robots_of(step):
        for regime in REGIMES:
            print(f"\n{results['titles'][robot]}, {REGIME_TITLES[regime]}: median (p99) [us]\n")
            print(step_table(step, robot, regime))
    if results["standing"]:
        print(f"\n{STANDING}: median (p99) [us]\n")
        print(standing_table(results["standing"]))
    for generator in generators_of(results["mpc"]):
        print(f"\n{generator}, time per tick: median (p99) [us]\n")
        print(mpc_table(results["mpc"], generator))
    if loop:
        print("\nClosed loop over DDS\n")
        print(loop_table(loop))
    share = 100.0 * results["pace"]["share"]
    print(f"\nA fixed piece of work ran at {share:.0f} % of the best speed seen meanwhile.")
    print("\nGoals\n")
    print(goal_table(results["goals"]))


def _write(results: dict[str, Any], output: Path) -> None:
    output.mkdir(parents=True, exist_ok=True)
    (output / "bench.json").write_text(json_text(results, 1) + "\n", encoding="utf-8")
    _plot(results, output)
    print(f"\nwritten: {output / 'bench.json'}", file=sys.stderr)


def _plot(results: dict[str, Any], folder: Path) -> None:
    if results["step"]:
        plot_step_times(results["step"], results["titles"], folder / FIGURE)
    if results["mpc"]:
        plot_ticks(results["mpc"], folder / TICK_FIGURE)

"""The results as Markdown tables, for the terminal and for the document."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks.steps.timed_controller import PARTS, Variant
from ghc_sim_bridge.programs.markdown import table

Row = dict[str, Any]

REGIME_TITLES = {
    "inactive": "no bound active",
    "active": "torque bounds active",
}


def robots_of(step: Sequence[Row]) -> list[str]:
    """Robots in the order of the results."""
    return list(dict.fromkeys(row["robot"] for row in step))


def variants_of(step: Sequence[Row]) -> list[Variant]:
    """Variants in the order of the results."""
    return list(dict.fromkeys(Variant(row["formulation"], row["solver"]) for row in step))


def rows_of(step: Sequence[Row], robot: str, regime: str, variant: Variant) -> list[Row]:
    """Results of one variant, by number of tasks."""
    wanted = (robot, regime, variant.formulation, variant.solver)
    keys = ("robot", "regime", "formulation", "solver")
    return [row for row in step if tuple(row[key] for key in keys) == wanted]


def step_table(step: Sequence[Row], robot: str, regime: str) -> str:
    """Median (p99) [us] of every variant against the number of tasks."""
    by_variant = {v: rows_of(step, robot, regime, v) for v in variants_of(step)}
    head = ["tasks", *(variant.title for variant in by_variant)]
    lines = []
    for cells in zip(*by_variant.values(), strict=True):
        times = [f"{row['median_us']:.0f} ({row['p99_us']:.0f})" for row in cells]
        lines.append([str(cells[0]["tasks"]), *times])
    return table(head, lines)


def parts_table(step: Sequence[Row], robot: str, regime: str, tasks: int) -> str:
    """Medians of the parts of a step [us]."""
    lines = []
    for variant in variants_of(step):
        for row in rows_of(step, robot, regime, variant):
            if row["tasks"] == tasks:
                parts = [f"{row['parts_us'][part]:.0f}" for part in PARTS]
                happened = [f"{row['qp_share'] * 100:.0f} %"]
                happened += [f"{row[key]:.1f}" for key in ("qps", "pivots", "active_bounds")]
                times = [f"{row[key]:.0f}" for key in ("median_us", "cpu_median_us")]
                lines.append([variant.title, *times, *parts, *happened])
    head = ["", "step", "CPU", *PARTS, "steps with a QP", "QPs", "pivots", "active bounds"]
    return table(head, lines)


def ratio_table(ratios: Sequence[Row], robot: str) -> str:
    """ghc_full over ghc against the number of tasks."""
    cases = dict.fromkeys((row["regime"], row["solver"]) for row in ratios)
    head = ["tasks", *(f"{REGIME_TITLES[regime]}, {solver}" for regime, solver in cases)]
    mine = [row for row in ratios if row["robot"] == robot]
    lines = []
    for tasks in dict.fromkeys(row["tasks"] for row in mine):
        values = {
            (row["regime"], row["solver"]): row["full_over_condensed"]
            for row in mine
            if row["tasks"] == tasks
        }
        lines.append([str(tasks), *(f"{values[case]:.1f}" for case in cases)])
    return table(head, lines)


def loop_table(loop: Sequence[Row]) -> str:
    """Steps per second and cycle times of each case."""
    head = [
        *("nodes", "executor", "steps per second", "real time factor"),
        *("cycle p50 [us]", "p99 [us]", "taken by host"),
        *("real time factor of the calmest run", "taken by host in it"),
    ]
    keys = (
        *("steps_per_second", "real_time_factor", "cycle_p50_us", "cycle_p99_us"),
        *("taken_by_host", "calmest_real_time_factor", "least_taken_by_host"),
    )
    forms = ("{:.0f}", "{:.2f}", "{:.0f}", "{:.0f}", "{:.0%}", "{:.2f}", "{:.0%}")
    lines = []
    for row in loop:
        nodes = "bridge, controller" + (", both generators" if row["generators"] else "")
        figures = [f.format(row[key]) for f, key in zip(forms, keys, strict=True)]
        lines.append([nodes, row["executor"], *figures])
    return table(head, lines)


def goal_table(goals: Sequence[Row]) -> str:
    """Each goal, what was measured, met or not."""
    return table(
        ["goal", "bounds", "at", "measured", ""],
        [
            [
                goal["goal"],
                REGIME_TITLES.get(goal["regime"], ""),
                f"{'at most' if goal['relation'] == '<=' else 'at least'} {goal['limit']:g}",
                f"{goal['measured']:.3g}",
                "met" if goal["met"] else "missed",
            ]
            for goal in goals
        ],
    )

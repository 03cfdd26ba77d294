"""Writes docs/results.md: results of the paper and the thesis next to those of our runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ghc_sim_bridge.programs.markdown import number, table
from ghc_sim_bridge.programs.paper import generator_sections as generators
from ghc_sim_bridge.programs.paper import motion_sections as motion
from ghc_sim_bridge.programs.paper import switching_sections as switching
from ghc_sim_bridge.programs.paper.pictures import write_pictures
from ghc_sim_bridge.programs.paper.runs import PAPER_RUNS
from ghc_sim_bridge.scenario.plan import RunPlan

_HEAD = """# Results: the experiments of the GHC paper and of the thesis

Written by `make paper` from the summaries of its runs; nothing here is typed in by hand. Each run
is the whole stack: bridge, controller and recorder as processes that talk over DDS, in lockstep.
*The paper* is Liu, Tan and Padois, *Generalized hierarchical control* (Autonomous Robots, 2016);
*the thesis* is M. Liu's of 2016: chapter 3 is the paper's longer form, chapters 4 and 5 smooth
constraints that jump (studies without a robot: [mpc_studies.md](mpc_studies.md)). Tasks: 1 = end
effector (position), 2 = elbow (position), 3 = posture. Gains, transition profile (eq. 15) and
regularization are the paper's: stiffness 30 /s², damping 20 /s (100 and 20 for a moving target),
weight 0.01. The torque rate limit is off unless a line says otherwise, so that the figures compare
methods and not the gate. A torque rate is the largest torque step of a joint over the control
period, and stands beside it.

The paper does not print its targets, its start posture or its inertial parameters. Ours stand in
`scenario/data/*.yaml` and in the robot's URDF. So the errors of tasks that have to give way, which
only measure how far apart the targets are, are not comparable in size; which task reaches zero is.

`cascade` is the default formulation, `ghc` the paper's own (`FORMULATION=ghc`). Accelerations are
damped towards -kd v (`velocity_damping`) by `cascade`, `balanced` and `weighted`. `hqp` damps them
towards 0 as in the literature, but for the run that says otherwise, and takes singular values
below 1e-4 of the largest as zero. `ghc` and `ghc_full` damp towards 0 as the paper does
(`formulation_parameters` of the scenario files). A joint speed that is left is the mean |v| of the
fastest joint over the last 3 s of a phase, or the last half of a shorter hold; with targets that
move there is none.
"""


@dataclass(frozen=True, slots=True)
class PaperResult:
    """A finished run."""

    plan: RunPlan
    summary: Mapping[str, Any]


Results = Mapping[str, PaperResult]


def write_document(results: Results, docs: Path) -> Path:
    """Write results.md and its figures into `docs`; returns the path of the document.

    Missing runs are listed; sections without any run are omitted.
    """
    docs.mkdir(parents=True, exist_ok=True)
    summaries = {name: result.summary for name, result in results.items()}
    pictures = write_pictures(results, docs / "figures")
    sections = [
        _HEAD,
        switching.table_section(summaries),
        switching.transition_section(summaries, pictures),
        motion.insertion_section(summaries, pictures),
        motion.lemniscate_section(summaries, pictures),
        motion.contact_section(summaries, pictures),
        motion.nonstrict_section(summaries, pictures),
        generators.force_section(summaries, pictures),
        generators.obstacle_section(summaries, pictures),
        _runs_section(summaries),
    ]
    path = docs / "results.md"
    text = "\n\n".join(section.strip() for section in sections if section)
    path.write_text(text + "\n", encoding="utf-8")
    return path


def _runs_section(summaries: Mapping[str, Mapping[str, Any]]) -> str:
    """Table of all runs: time, failures, limits."""
    rows = []
    for run in PAPER_RUNS:
        summary = summaries.get(run.name)
        if summary is None:
            rows.append([f"`{run.name}`", *["not run"] * 7])
            continue
        excess = max(summary["limit_violations"].values(), default=0.0)
        ended = all(code == 0 for code in summary["nodes"].values())
        rows.append(
            [
                f"`{run.name}`",
                f"{summary['sim_seconds']:g}",
                number(summary["real_time_factor"], 3),
                number(summary["step_time_us"]["p50"], 3),
                str(summary["qp_failures"]),
                str(summary["fallback_ticks"]),
                number(100.0 * excess),
                "all 0" if ended else str(dict(summary["nodes"])),
            ]
        )
    head = [
        "run",
        "simulated [s]",
        "x real time",
        "control step, median [µs]",
        "QP failures",
        "fallback ticks",
        "largest excess of a limit [%]",
        "exit codes",
    ]
    return (
        "## The runs\n\n"
        f"{table(head, rows)}\n\n"
        "Times are wall times of one machine while it did other work as well; `make bench` "
        "measures them properly. `qp_failures` are ticks at which no torque met the hard rows."
    )

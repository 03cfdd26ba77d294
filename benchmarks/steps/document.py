"""docs/benchmarks.md, from the results alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks.loops.loop_bench import FORMULATION
from benchmarks.previews.mpc_section import tick_section
from benchmarks.soak.section import GENERATORS
from benchmarks.steps.standing_bench import standing_section
from benchmarks.steps.step_bench import REGIMES
from benchmarks.steps.tables import (
    REGIME_TITLES,
    goal_table,
    loop_table,
    parts_table,
    ratio_table,
    robots_of,
    step_table,
)
from benchmarks.steps.timed_controller import PARTS
from ghc_sim_bridge.programs.markdown import picture

FIGURE = "step_time.png"
_PARTS_AT = 5  # tasks

_INTRODUCTION = """# Time per control step

Written by `make bench ARGS=--write-docs`. The paper's figure 12 asks the same question: how long
does one step take, against the number of tasks? Here every formulation answers it in one run, in
the same states, with the same model and through the same `Controller.step`: model terms, task
rows, bounds, projectors, QP, output gate. Below that: time per plan of the constraint generators,
their memory, and the closed loop over DDS.
"""

_CASES = """## What is compared

- **Robots.** The KUKA LWR (7 joints, 1 to 5 tasks) and iCub (32 joints of legs, torso, arms and
  neck, fixed at the pelvis, 1 to 7 tasks): a posture task of all joints, below motion tasks of
  three rows each, in strict order. iCub comes from the package `icub-models`, installed when the
  benchmark first runs.
- **States.** Consecutive states, 1 ms apart, of a closed loop that runs to random goals, new ones
  every {length} steps; {steps} timed steps for each figure. Formulations take turns every {length}
  steps, numbers of tasks and regimes several times in all, in random order, so that what else the
  machine does hits all alike.
- **No bound active.** Joint position, velocity and torque limits are evaluated and none is
  reached. The condensed formulations, `cascade` and `hqp` then need no QP. `ghc_full` solves its
  QP all the same: it is the paper's eq. 13 as it stands.
- **Torque bounds active.** A bound about gravity of {share:.0f} % of the largest torque that the
  tasks asked for without it, per joint. How many bounds are active on average (met to 1e-6, which
  ProxQP's answers often miss) stands in the tables. The torque rate limit is off in both.
- **Formulations.** `ghc_full`: one variable nu'_i per task. `ghc`: the same optimum, condensed and
  whitened. `balanced` and `weighted`; `cascade` (the default), level after level in smooth null
  spaces, with a QP only where the optimum of a level is beyond a bound; and `hqp`, a cascade with
  all bounds at every level. Solvers: DAQP (the default; exact active set) and, where
  it says so, ProxQP.
- **Settings.** w = 1e-2, control period 1 ms, one thread for linear algebra.
"""

_NOTES = """## What to keep in mind

- The model and everything around it cost the same for all and belong to the step: they bound the
  ratio from above, the more so on a small robot. The ratio of the solves alone is larger.
- `ghc_full` and `hqp` assemble their matrices in NumPy, `ghc`, `balanced` and `weighted` in
  the compiled core, where `cascade` is as a whole; rows of the QP, solvers and
  checks are the same code for all. A compiled cascade of QPs would be several times faster than
  `hqp` here: it stands for the same language and the same solver, not for the best HQP there is.
- With more than ten rows active DAQP starts from the active set of the step before. This helps
  where bounds stay active for many steps, as here, and costs nothing where they do not.
- In a transition more tasks restrict each other: the projectors take about twice as long.
- p99 shows the other programs of a shared machine as much as the method; the column CPU is the
  median of the processor time, which waiting does not enter.
- The paper's figures (2.7 ms for the arm and 88 ms for iCub with five tasks, C++, a PC of 2015)
  are context: other hardware, other solver.
"""


def write_document(results: dict[str, Any], docs: Path) -> None:
    """Write docs/benchmarks.md; the figure is expected beside it in figures/."""
    parts = [
        _INTRODUCTION,
        _machine(results),
        "## Goals\n\n" + goal_table(results["goals"]) + "\n",
    ]
    if results["step"]:
        parts += _step(results)
    parts.append(standing_section(results["standing"]))
    if results["mpc"]:
        parts += tick_section(results["mpc"])
    if results["loop"]:
        parts.append(_loop(results))
    parts.append(_NOTES)
    docs.mkdir(parents=True, exist_ok=True)
    path = docs / "benchmarks.md"
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    path.write_text(GENERATORS.keep("\n".join(parts), before), encoding="utf-8")


def _machine(results: dict[str, Any]) -> str:
    facts, load, pace = results["machine"], results["load_average"], results["pace"]
    short = "**A short run: too few steps for figures to be quoted.** "
    versions = ", ".join(f"{name} {number}" for name, number in facts["versions"].items())
    return (short if results["settings"]["quick"] else "") + (
        f"Measured at commit {facts['commit'] or 'unknown'} on {facts['cores']} cores of "
        f"{facts['cpu']}, {facts['system']}, Python {facts['python']}, {versions}. "
        f"The machine is shared: load average {load['before']:g} "
        f"before and {load['after']:g} at the end, of which this benchmark is about 1. A fixed "
        f"loop of plain Python, timed in between, took {pace['best_us']:.0f} us at its fastest "
        f"and {pace['median_us']:.0f} us in the median: that is the pace of the machine itself, "
        "whose host is shared too.\n"
    )


def _step(results: dict[str, Any]) -> list[str]:
    step, settings = results["step"], results["settings"]
    caption = "Median time per step, whiskers up to the 99th percentile"
    parts = [
        picture(FIGURE, caption) + "\n",
        _CASES.format(
            length=settings["segment_length"],
            steps=settings["steps"],
            share=100.0 * settings["torque_share"],
        ),
        "## Time per step\n\nMedian (p99) in microseconds.\n",
    ]
    for robot in robots_of(step):
        title = results["titles"][robot]
        for regime in REGIMES:
            parts.append(f"### {title}, {REGIME_TITLES[regime]}\n")
            parts.append(step_table(step, robot, regime) + "\n")
        parts.append(f"`ghc_full` over `ghc`, {title}:\n")
        parts.append(ratio_table(results["ratios"], robot) + "\n")
    parts.append(f"## Where the time goes, {_PARTS_AT} tasks\n")
    parts.append(
        "Medians in microseconds. "
        + "; ".join(f"{name}: {meaning}" for name, meaning in PARTS.items())
        + ". The last columns are means per step: QPs and their pivots (iterations of ProxQP).\n"
    )
    for robot in robots_of(step):
        for regime in REGIMES:
            parts.append(f"{results['titles'][robot]}, {REGIME_TITLES[regime]}:\n")
            parts.append(parts_table(step, robot, regime, _PARTS_AT) + "\n")
    return parts


def _loop(results: dict[str, Any]) -> str:
    return (
        "## Closed loop over DDS\n\n"
        "Nodes as processes in lockstep at 1 kHz, KUKA LWR with its three tasks and "
        f"`{FORMULATION}`: physics, two messages, one control step a cycle. With both generators, "
        "the tool is in contact by a schedule whose largest force jumps twice a second, and a "
        "wall that only the sensor sees jumps towards the elbow and away once a second; every "
        "10 ms the controller waits for both plans. With the fast executor bridge and controller "
        "share a CPU, the other nodes have the rest. The calmest run is the one from which the "
        "host of the virtual machine took the least CPU time.\n\n"
        + loop_table(results["loop"])
        + "\n"
    )

"""Output of `make soak`: table, figure, section of docs/benchmarks.md."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.soak.memory import GROWTH_GOAL, MemoryCourse
from benchmarks.soak.section import GENERATORS
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import picture, table

FIGURE = "generator_memory.png"

_CAPTION = "Resident memory since the end of the warm-up (grey); line: the goal"
_TEXT = """## Memory of the generators

{short}Each generator as a process of its own, asked over DDS for plan after plan as fast as it
answers, for {simulated:g} s of simulated time ({plans} plans each). Ten times a second a schedule
is replaced, or all obstacles jump and some come and go. Resident memory in MB (1e6 bytes) from
`/proc`, without the first {warm_up:g} s; growth is the difference of the medians of the first and
the last 5 % of the rest. Goal: at most {goal:g} MB.
"""


def soak_table(rows: Sequence[dict[str, Any]]) -> str:
    """One line per node, sizes in MB."""
    head = ["node", "handles", "plans", "after the warm-up", "end", "peak", "growth", ""]
    return table(
        head,
        [
            [
                f"`{row['node']}`",
                str(row["handled"]),
                str(row["plans"]),
                *(f"{row[key]:.1f}" for key in ("warm_mb", "last_mb", "peak_mb")),
                f"{row['growth_mb']:.2f}",
                "met" if row["met"] else "missed",
            ]
            for row in rows
        ],
    )


def plot_memory(courses: Sequence[MemoryCourse], path: Path) -> None:
    """Change of resident memory since the end of the warm-up, which is gray; gray line: goal."""
    figure = new_figure(6.0, 2.6)
    with styled():
        ax = figure.subplots()
    for index, course in enumerate(courses):
        change = np.array(course.resident) - course.warm_memory()
        ax.plot(course.times, change, color=colour(index), label=course.node)
    ax.axvspan(0.0, courses[0].warm_up, color="#DDDDDD", lw=0, zorder=0)
    ax.axhline(GROWTH_GOAL, color="#999999", lw=0.8, zorder=0)
    ax.set_xlim(0.0, courses[0].times[-1])
    ax.set_ylim(min(-0.5, ax.get_ylim()[0]), max(1.25 * GROWTH_GOAL, ax.get_ylim()[1]))
    ax.set_xlabel("simulated time [s]")
    ax.set_ylabel("change of memory [MB]")
    ax.legend(loc="upper right")
    save_png(figure, path)


def write_soak_section(results: dict[str, Any], document: Path) -> None:
    """Put the results into the document; the figure is expected beside it in figures/."""
    rows = results["nodes"]
    short = "**A short run: too short for figures to be quoted.** " if results["quick"] else ""
    text = _TEXT.format(
        short=short,
        simulated=rows[0]["simulated_s"],
        plans=rows[0]["plans"],
        warm_up=rows[0]["warm_up_s"],
        goal=GROWTH_GOAL,
    )
    body = "\n".join([text, soak_table(rows) + "\n", picture(FIGURE, _CAPTION)])
    before = document.read_text(encoding="utf-8") if document.exists() else ""
    document.write_text(GENERATORS.put(before, body), encoding="utf-8")

"""The plot of time per step against the number of tasks, like figure 12 of the GHC paper."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter

from benchmarks.steps.step_bench import REGIMES
from benchmarks.steps.tables import REGIME_TITLES, robots_of, rows_of, variants_of
from benchmarks.steps.timed_controller import Variant
from ghc_sim_bridge.figures.style import COLOURS, new_figure, save_png, styled

Row = dict[str, Any]

_ORDER = ("ghc_full", "hqp", "weighted", "balanced", "ghc", "cascade")
_TICKS = (2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000)  # [us]


def plot_step_times(step: Sequence[Row], titles: dict[str, str], path: Path) -> None:
    """One column per robot, one row per regime; lines are medians, whiskers reach to p99."""
    robots = robots_of(step)
    figure = new_figure(3.9 * len(robots), 5.6)
    with styled():
        grid = figure.subplots(len(REGIMES), len(robots), squeeze=False, sharex="col", sharey=True)
    for axes, regime in zip(grid, REGIMES, strict=True):
        for ax, robot in zip(axes, robots, strict=True):
            for index, variant in enumerate(variants_of(step)):
                _draw(ax, rows_of(step, robot, regime, variant), variant, 0.06 * (index - 3.5))
            ax.set_title(f"{titles.get(robot, robot)}: {REGIME_TITLES[regime]}")
            ax.set_yscale("log")
            ax.yaxis.set_major_locator(FixedLocator(_TICKS))
            ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            ax.yaxis.set_minor_formatter(NullFormatter())
            ax.xaxis.set_major_locator(MaxNLocator(integer=True))
            ax.grid(True, which="both", axis="y")
        axes[0].set_ylabel("time per control step [us]")
    for ax in grid[-1]:
        ax.set_xlabel("tasks (posture and motion tasks)")
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    save_png(figure, path)


def _draw(ax: Axes, rows: Sequence[Row], variant: Variant, shift: float) -> None:
    tasks = np.array([row["tasks"] for row in rows]) + shift
    median = np.array([row["median_us"] for row in rows])
    above = np.array([max(row["p99_us"] - row["median_us"], 0.0) for row in rows])
    is_default = variant.solver == "daqp"
    ax.errorbar(
        tasks,
        median,
        yerr=[np.zeros_like(above), above],
        color=COLOURS[_ORDER.index(variant.formulation)],
        linestyle="-" if is_default else "--",
        marker="o" if is_default else "s",
        markersize=3.0,
        elinewidth=0.6,
        label=variant.title,
    )

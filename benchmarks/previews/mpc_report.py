"""Tables and figure of the generators' ticks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

from benchmarks.previews.mpc_bench import KINDS
from benchmarks.steps.goals import TICK_GOAL
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table

Row = dict[str, Any]

KIND_TITLES = {"warm": "change seen before", "changed": "new inputs", "first": "first tick"}
_TICKS = (50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000)  # [us]


def generators_of(mpc: Sequence[Row]) -> list[str]:
    """Generators in the order of the results."""
    return list(dict.fromkeys(row["generator"] for row in mpc))


def mpc_rows(mpc: Sequence[Row], generator: str, **wanted: float) -> list[Row]:
    """Rows of one generator with this `horizon` [s] or `count`."""
    mine = [row for row in mpc if row["generator"] == generator]
    return [row for row in mine if all(row[key] == value for key, value in wanted.items())]


def mpc_table(mpc: Sequence[Row], generator: str) -> str:
    """Median (p99) [us] by horizon and kind of tick, against the number of rows."""
    mine = mpc_rows(mpc, generator)
    counts = sorted({row["count"] for row in mine})
    noun = mine[0]["handles"]
    lines = []
    for kind in KINDS:
        for horizon in sorted({row["horizon"] for row in mine}):
            by_count = {row["count"]: row for row in mpc_rows(mpc, generator, horizon=horizon)}
            cells = []
            for count in counts:
                times = by_count[count]["ticks_us"][kind]
                cells.append(f"{times['median']:.0f} ({times['p99']:.0f})")
            lines.append([f"{KIND_TITLES[kind]}, {horizon:g} s", *cells])
    return table(["tick, N T", *(f"{count} {noun}" for count in counts)], lines)


def start_table(mpc: Sequence[Row]) -> str:
    """Construction time of a generator [ms]: matrices of the horizon."""
    horizons = sorted({row["horizon"] for row in mpc})
    lines = []
    for generator in generators_of(mpc):
        times = [
            np.median([row["start_us"] for row in mpc_rows(mpc, generator, horizon=horizon)])
            for horizon in horizons
        ]
        lines.append([f"`{generator}`", *(f"{time * 1e-3:.1f}" for time in times)])
    return table(["N T", *(f"{horizon:g} s" for horizon in horizons)], lines)


def plot_ticks(mpc: Sequence[Row], path: Path) -> None:
    """One column per generator; a line per count, whiskers reach to p99."""
    generators = generators_of(mpc)
    figure = new_figure(3.9 * len(generators), 3.4)
    with styled():
        grid = figure.subplots(1, len(generators), squeeze=False, sharey=True)
    for ax, generator in zip(grid[0], generators, strict=True):
        for index, count in enumerate(sorted({row["count"] for row in mpc})):
            rows = mpc_rows(mpc, generator, count=count)
            _draw(ax, rows, colour(index), 1.0 + 0.02 * (index - 1.5), str(count))
        ax.axhline(TICK_GOAL, color="#999999", lw=0.8, zorder=0)
        horizons = sorted({row["horizon"] for row in mpc})
        ax.set_title(generator)
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(FixedLocator(horizons))
        ax.xaxis.set_minor_locator(NullLocator())
        ax.set_yscale("log")
        ax.yaxis.set_major_locator(FixedLocator(_TICKS))
        ax.yaxis.set_minor_formatter(NullFormatter())
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        ax.set_xlabel("horizon N T [s]")
    grid[0][0].set_ylabel("time per tick [us]")
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", ncols=4, title="contacts or obstacles"
    )
    save_png(figure, path)


def _draw(ax: Axes, rows: Sequence[Row], shade: str, shift: float, label: str) -> None:
    horizons = np.array([row["horizon"] for row in rows]) * shift
    times = [row["ticks_us"]["warm"] for row in rows]
    median = np.array([time["median"] for time in times])
    above = np.array([max(time["p99"] - time["median"], 0.0) for time in times])
    ax.errorbar(
        horizons,
        median,
        yerr=[np.zeros_like(above), above],
        color=shade,
        marker="o",
        markersize=3.0,
        elinewidth=0.6,
        label=label,
    )
    changed = [row["ticks_us"]["changed"]["median"] for row in rows]
    ax.plot(horizons, changed, color=shade, linestyle=":", marker="x", markersize=4.0)

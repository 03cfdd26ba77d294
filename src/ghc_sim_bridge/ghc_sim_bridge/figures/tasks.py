"""Priorities and task errors of one run (GHC paper, figures 2 to 4 and 7)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.figures.style import (
    colour,
    label_phases,
    mark_phases,
    new_figure,
    run_title,
)
from ghc_sim_bridge.logs.controller_trace import ControllerTrace

_SMALLEST_ERROR = 1e-8  # lower end of logarithmic axes
_MANY_TASKS = 4  # with more tasks, only changing priorities are drawn


def tasks_figure(analysis: Analysis, trace: ControllerTrace) -> Figure:
    """Priorities at the top, task errors below, linear and logarithmic (figures 2 to 4, 7)."""
    pairs = alpha_panels(trace)
    figure = new_figure(9.0, 4.6 + 0.62 * len(pairs))
    axes = figure.subplots(
        len(pairs) + 2, 1, sharex=True, height_ratios=[0.45] * len(pairs) + [1.5, 1.5]
    )
    draw_alphas(axes[: len(pairs)], pairs, trace)
    linear, logarithmic = axes[-2:]
    _draw_errors(linear, analysis)
    for index, task in enumerate(analysis.history.tasks):
        error = np.maximum(task.error, _SMALLEST_ERROR)
        label = f"{index + 1}: {task.name} [{task.unit}]"
        logarithmic.semilogy(analysis.history.time, error, color=colour(index), label=label)
    logarithmic.set_ylabel("task error [m], [rad]")
    logarithmic.set_xlabel("time [s]")
    logarithmic.yaxis.set_major_locator(LogLocator(numticks=6))
    logarithmic.yaxis.set_minor_formatter(NullFormatter())
    figure.legend(
        *logarithmic.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=min(len(analysis.history.tasks), _MANY_TASKS),
    )
    for ax in axes:
        mark_phases(ax, analysis.plan.phases)
    names = [task.name for task in analysis.history.tasks]
    label_phases(axes[0], analysis.plan.phases, names)
    figure.suptitle(run_title(analysis), fontsize=10)
    return figure


def alpha_panels(trace: ControllerTrace) -> list[list[tuple[int, int]]]:
    """One panel per pair of tasks, and one for removals, if any.

    With many tasks only pairs whose priority changes; the first pair if none does.
    """
    alpha = trace.alpha_over_time()
    count = len(trace.tasks)
    pairs = [[(i, j), (j, i)] for i in range(count) for j in range(i + 1, count)]
    removed = [(i, i) for i in range(count) if alpha[:, i, i].max(initial=0.0) > 0.0]
    if count > _MANY_TASKS:
        changing = np.ptp(alpha, axis=0) > 0.0
        pairs = [pair for pair in pairs if any(changing[entry] for entry in pair)] or pairs[:1]
        removed = [entry for entry in removed if changing[entry]]
    return pairs + ([removed] if removed else [])


def draw_alphas(
    axes: Sequence[Axes], panels: list[list[tuple[int, int]]], trace: ControllerTrace
) -> None:
    """One panel of priorities over time for each group of pairs (i, j) of tasks."""
    alpha = trace.alpha_over_time()
    for ax, panel in zip(axes, panels, strict=True):
        for (i, j), style in zip(panel, cycle(("-", "--", ":")), strict=False):
            ax.plot(
                trace.time,
                alpha[:, i, j],
                style,
                color=colour(i),
                label=rf"$\alpha_{{{i + 1}{j + 1}}}$",
            )
        ax.set_ylim(-0.1, 1.1)
        ax.set_yticks([0.0, 1.0])
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.4, fontsize=9)


def _draw_errors(ax: Axes, analysis: Analysis) -> None:
    """Errors on linear axes: meters on the left, radians on the right."""
    tasks = analysis.history.tasks
    angles = ax.twinx() if any(task.unit == "rad" for task in tasks) else None
    for index, task in enumerate(tasks):
        side = angles if angles is not None and task.unit == "rad" else ax
        side.plot(analysis.history.time, task.error, color=colour(index))
    ax.set_ylabel("task error [m]")
    ax.set_ylim(bottom=0.0)
    if angles is not None:
        angles.grid(visible=False)
        angles.set_ylabel("task error [rad]")
        angles.set_ylim(bottom=0.0)
        angles.spines["right"].set_visible(True)

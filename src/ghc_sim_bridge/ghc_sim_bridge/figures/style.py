"""Looks that all figures share: colours, phases, hierarchy labels, saving."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.colors import PALETTE, color
from ghc_sim_bridge.scenario.plan import PlannedPhase

COLOURS = PALETTE
_BAND = "#DDDDDD"
_STYLE: Mapping[str, object] = {
    "font.size": 9.0,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.color": "#CCCCCC",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "axes.titlesize": 9.0,
}
MOVES = 1e-6  # [m] a reference that stays within this is static
_DPI = 110
_PALETTE = 128  # colours kept in a PNG: line drawings need no more, and files stay small


def new_figure(width: float, height: float) -> Figure:
    """An empty figure [inch] that needs no display."""
    with mpl.rc_context(dict(_STYLE)):
        return Figure(figsize=(width, height), layout="constrained")


def styled() -> AbstractContextManager[None]:
    """Context in which axes are made with the common style."""
    return mpl.rc_context(dict(_STYLE))


def colour(index: int) -> str:
    """Colour of the task or joint at an index."""
    return color(index)


def short_hierarchy(hierarchy: str, tasks: Sequence[str]) -> str:
    """`end_effector > elbow` as the paper writes it, 1 \u25b7 2: numbers by the order of tasks."""
    text = hierarchy
    for index, task in enumerate(tasks):
        text = re.sub(rf"\b{re.escape(task)}\b", str(index + 1), text)
    return text.replace(">", "\u25b7")


def mark_phases(ax: Axes, phases: Sequence[PlannedPhase]) -> None:
    """Grey bands where the priorities ramp, a thin line where they switch at once."""
    for planned in phases[1:]:
        if planned.ramp >= 0.05:
            ax.axvspan(planned.start, planned.start + planned.ramp, color=_BAND, lw=0, zorder=0)
        else:
            ax.axvline(planned.start, color="#999999", lw=0.8, zorder=0)
    ax.set_xlim(0.0, phases[-1].end)


def label_phases(ax: Axes, phases: Sequence[PlannedPhase], tasks: Sequence[str]) -> None:
    """The hierarchy of each phase above an axes."""
    for planned in phases:
        middle = 0.5 * (planned.start + planned.ramp + planned.end)
        text = short_hierarchy(planned.phase.hierarchy, tasks)
        ax.annotate(
            text,
            (middle, 1.0),
            (0, 4),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=9.5,
        )


def envelope(
    time: NDArray[np.float64], values: NDArray[np.float64], block: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest value of each block of rows, so that thinning a curve keeps its peaks."""
    count = len(values) // block
    if block <= 1 or count == 0:
        return time, values
    return time[: count * block : block], values[: count * block].reshape(count, block).max(axis=1)


def save_png(figure: Figure, path: Path) -> None:
    """Write a figure as a PNG with a palette."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=_DPI, facecolor="white")
    with Image.open(path) as image:
        small = image.convert("RGB").quantize(_PALETTE, dither=Image.Dither.NONE)
    small.save(path, optimize=True)


def run_title(analysis: Analysis) -> str:
    """What ran: scenario, formulation, transitions, control period."""
    plan = analysis.plan
    ramp = f"transitions of {plan.transition:g} s" if plan.transition else "switched at once"
    if plan.torque_rate > 0.0:
        least = f"at least {plan.transition:g} s, " if plan.transition else ""
        ramp = f"transitions of {least}{plan.torque_rate:g} Nm/s"
    period = f"control period {1e3 * analysis.log.control_dt:g} ms"
    return f"{plan.scenario.title} ({plan.formulation}, {ramp}, {period})"

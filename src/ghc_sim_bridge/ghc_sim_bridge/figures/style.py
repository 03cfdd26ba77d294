"""Common style of all figures: colors, phases, hierarchy labels, saving."""

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
from ghc_sim_bridge.colors import PALETTE, color, rgb
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
_PALETTE = 160  # colors of a PNG: enough for line drawings, with small files


def new_figure(width: float, height: float) -> Figure:
    """An empty figure, size in [inch], that needs no display."""
    with mpl.rc_context(dict(_STYLE)):
        return Figure(figsize=(width, height), layout="constrained")


def styled() -> AbstractContextManager[None]:
    """Context for creating axes with the common style."""
    return mpl.rc_context(dict(_STYLE))


def colour(index: int) -> str:
    """Color of the task or joint with an index."""
    return color(index)


def short_hierarchy(hierarchy: str, tasks: Sequence[str]) -> str:
    """`end_effector > elbow` in the paper's notation, 1 \u25b7 2, with task numbers."""
    text = hierarchy
    for index, task in enumerate(tasks):
        text = re.sub(rf"\b{re.escape(task)}\b", str(index + 1), text)
    return text.replace(">", "\u25b7")


def mark_phases(ax: Axes, phases: Sequence[PlannedPhase]) -> None:
    """Gray bands during ramps of priorities, a thin line at switches."""
    for planned in phases[1:]:
        if planned.ramp >= 0.05:
            ax.axvspan(planned.start, planned.start + planned.ramp, color=_BAND, lw=0, zorder=0)
        else:
            ax.axvline(planned.start, color="#999999", lw=0.8, zorder=0)
    ax.set_xlim(0.0, phases[-1].end)


def label_phases(ax: Axes, phases: Sequence[PlannedPhase], tasks: Sequence[str]) -> None:
    """Write the hierarchy of each phase above the axes."""
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
        small = _reduced(image.convert("RGB"))
    small.save(path, optimize=True)


def _reduced(image: Image.Image) -> Image.Image:
    """The image in few colors: those of large areas, rare ones, and the exact colors of curves."""
    named = np.array([rgb(index) for index in range(len(COLOURS))])
    areas = _colours(image.quantize(_PALETTE // 2, Image.Quantize.MEDIANCUT))
    rare = _colours(image.quantize(_PALETTE // 2 - len(named), Image.Quantize.MAXCOVERAGE))
    palette = np.unique(np.concatenate([named, areas, rare]), axis=0)
    found, where = np.unique(np.asarray(image).reshape(-1, 3), axis=0, return_inverse=True)
    squares = (palette**2).sum(axis=1) - 2 * found.astype(np.int64) @ palette.T
    nearest = squares.argmin(axis=1).astype(np.uint8)
    reduced = Image.fromarray(nearest[where].reshape(image.height, image.width), "P")
    reduced.putpalette(palette.astype(np.uint8).tobytes())
    return reduced


def _colours(image: Image.Image) -> NDArray[np.int64]:
    """Used colors of a palette, one per row."""
    used = image.convert("RGB").getcolors(_PALETTE) or []
    return np.array([colour for _, colour in used], dtype=np.int64)


def run_title(analysis: Analysis) -> str:
    """Title of a run: scenario, formulation, transitions, control period."""
    plan = analysis.plan
    ramp = f"transitions of {plan.transition:g} s" if plan.transition else "switched at once"
    if plan.torque_rate > 0.0:
        least = f"at least {plan.transition:g} s, " if plan.transition else ""
        ramp = f"transitions of {least}{plan.torque_rate:g} Nm/s"
    if plan.scenario.priority_share and len(plan.phases) == 1:
        ramp = f"priorities by the error of {plan.scenario.priority_share['task']}"
    period = f"control period {1e3 * analysis.log.control_dt:g} ms"
    return f"{plan.scenario.title} ({plan.formulation}, {ramp}, {period})"

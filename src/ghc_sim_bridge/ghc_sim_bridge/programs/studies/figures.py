"""Figures of the thesis, drawn from our runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes

from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.studies.force_study import ForceCase, ForceRun, run_both_bounds
from ghc_sim_bridge.programs.studies.motion_study import MotionCase, MotionRun
from ghc_sim_bridge.programs.studies.plan_of_studies import (
    GAMMAS,
    HORIZONS,
    JUMPS,
    MOTION_HORIZONS,
    WEIGHTS,
    Studies,
)

_RAW = {"color": "#7F7F7F", "lw": 0.9, "ls": "--"}


def write_figures(studies: Studies, folder: Path) -> None:
    """Write mpc_*.png into a folder."""
    _evolution(studies, folder / "mpc_force_evolution.png")
    _sweep(studies.by_weight(), WEIGHTS, "α [s²]", True, folder / "mpc_force_weight.png")
    _sweep(studies.by_horizon(), HORIZONS, "NT [s]", False, folder / "mpc_force_horizon.png")
    _grids(studies, folder / "mpc_force_grid.png")
    _motion(studies, folder / "mpc_obstacle_evolution.png")
    _overshoot(studies, folder / "mpc_obstacle_overshoot.png")


def _evolution(studies: Studies, path: Path) -> None:
    """Figures 5.3 and 5.4."""
    figure = new_figure(7.5, 2.4)
    with styled():
        left, right = figure.subplots(1, 2)
    run = studies.force[ForceCase()]
    left.plot(run.time, run.raw, **_RAW, label="raw")
    left.plot(run.time, run.upper, color=colour(0), label="smoothed")
    time, raw, smooth = run_both_bounds()
    for column, name in enumerate(("lower", "upper")):
        right.plot(time, raw[:, column], **_RAW)
        right.plot(time, smooth[:, column], color=colour(1 - column), label=name)
    for axes, title in ((left, "maximum alone (fig. 5.3)"), (right, "both bounds (fig. 5.4)")):
        _label(axes, title, "time [s]", "force [N]")
    save_png(figure, path)


def _sweep(
    runs: Sequence[ForceRun], values: Sequence[float], name: str, log: bool, path: Path
) -> None:
    """Figures 5.5 and 5.7: evolution, largest derivative, approximation error."""
    figure = new_figure(8.5, 2.4)
    with styled():
        first, second, third = figure.subplots(1, 3)
    first.plot(runs[0].time, runs[0].raw, **_RAW)
    shown = range(0, len(runs), 2)
    for place, index in enumerate(shown):
        first.plot(
            runs[index].time, runs[index].upper, color=colour(place), label=f"{values[index]:g}"
        )
    second.plot(values, [run.largest_rate for run in runs], "o-", ms=3, color=colour(0))
    third.plot(values, [run.error for run in runs], "o-", ms=3, color=colour(1))
    if log:
        second.set_xscale("log")
        third.set_xscale("log")
    second.set_yscale("log")
    _label(first, f"by {name}", "time [s]", "force [N]")
    _label(second, "largest derivative", name, "[N/s]")
    _label(third, "approximation error E", name, "[N]")
    save_png(figure, path)


def _grids(studies: Studies, path: Path) -> None:
    """Figures 5.8 to 5.10."""
    figure = new_figure(9.4, 2.4)
    with styled():
        panels = figure.subplots(1, 3)
    for axes, jump in zip(panels[:2], (5.0, 50.0), strict=True):
        for place, row in enumerate(studies.grid(jump)[::2]):
            axes.plot(
                HORIZONS,
                [run.largest_rate for run in row],
                "o-",
                ms=2.5,
                color=colour(place),
                label=f"α = {row[0].case.weight:g} s²" if axes is panels[0] else None,
            )
        axes.set_yscale("log")
        _label(axes, f"jump of {jump:g} N", "NT [s]", "largest derivative [N/s]")
    rates = [run.largest_rate for run in studies.by_jump()]
    panels[2].plot(JUMPS, rates, "o-", ms=3, color=colour(0))
    _label(panels[2], "α = 0.4 s², NT = 1 s", "jump [N]", "largest derivative [N/s]")
    panels[0].get_legend().remove()  # it would cover the curves
    figure.legend(loc="outside right center", fontsize=7, frameon=False)
    save_png(figure, path)


def _motion(studies: Studies, path: Path) -> None:
    """Figures 4.5 and 4.8."""
    figure = new_figure(8.5, 4.2)
    with styled():
        panels = figure.subplots(2, 3)
    names = ("position [m]", "velocity [m/s]", "acceleration [m/s²]")
    for row, dynamic in zip(panels, (False, True), strict=True):
        run = studies.motion[MotionCase(dynamic=dynamic)]
        row[0].plot(run.time, run.raw, **_RAW)
        title = f"with D (fig. 4.8): {run.overshoot:.1f} %" if dynamic else ""
        title = title or f"constant weight (fig. 4.5): {run.overshoot:.1f} %"
        for order, axes in enumerate(row):
            axes.plot(run.time, run.state[:, order], color=colour(order))
            _label(axes, title if order == 0 else "", "time [s]", names[order])
    save_png(figure, path)


def _overshoot(studies: Studies, path: Path) -> None:
    """Figures 4.6 and 4.7."""
    figure = new_figure(8.5, 4.2)
    with styled():
        panels = figure.subplots(2, 2)
    groups: Sequence[tuple[Sequence[MotionRun], Sequence[float], str]] = (
        (studies.by_gamma(), GAMMAS, "γ [s⁶]"),
        (studies.by_motion_horizon(), MOTION_HORIZONS, "NT [s]"),
    )
    for row, (runs, values, name) in zip(panels, groups, strict=True):
        row[0].plot(runs[0].time, runs[0].raw, **_RAW)
        for place, index in enumerate(range(0, len(runs), 2)):
            row[0].plot(
                runs[index].time,
                runs[index].state[:, 0],
                color=colour(place),
                label=f"{values[index]:g}",
            )
        row[0].set_xlim(3.0, 8.5)
        row[1].plot(values, [run.overshoot for run in runs], "o-", ms=3, color=colour(0))
        row[1].set_ylim(bottom=0.0)
        if name.startswith("γ"):
            row[1].set_xscale("log")
        _label(row[0], f"by {name}", "time [s]", "position [m]")
        _label(row[1], "overshoot", name, "[%]")
    save_png(figure, path)


def _label(axes: Axes, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=9)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="best", fontsize=7)

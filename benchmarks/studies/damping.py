"""Damping w and velocity damping kd over the five phases of `priority_switching`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.axes import Axes

import ghc_controller as ghc
from benchmarks.study_results import shown
from benchmarks.switching_loop import Timing, run_phases
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "damping"
TITLE = "KUKA, damping of the levels and of the velocity"
FORMULATIONS = ("cascade",)
FIGURE = "damping.png"
CAPTION = (
    "Worst first task, torque rate (@ 1 ms) and jerk of the first switch against "
    "velocity_damping, for four regularizations w"
)
_W = (1e-3, 3e-3, 1e-2, 3e-2)  # [-]
_KD = (0.0, 5.0, 10.0, 20.0, 40.0)  # [1/s]
_PANELS = (
    ("first_task", "first task, worst phase [m, rad]", 3e-5),
    ("torque_rate", "torque rate, phases 2 to 5 [Nm/s]", 300.0),
    ("jerk", "jerk integral, phase 2 [rad/s^2]", 140.0),
)  # key, title, goal
_QUICK = Timing(ramp=0.02, hold=0.03)


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """One closed loop per pair of w and kd."""
    timing = _QUICK if quick else Timing()
    w_values, kd_values = (_W[:1], _KD[:2]) if quick else (_W, _KD)
    found = {
        name: [_run(name, w, kd, timing) for w in w_values for kd in kd_values]
        for name in formulations
    }
    return {"facts": {"w": w_values, "kd": kd_values}, "formulations": found}


def _run(formulation: str, w: float, kd: float, timing: Timing) -> dict[str, Any]:
    settings = ghc.FormulationSettings(regularization=w, velocity_damping=kd)
    result = run_phases(formulation, settings, timing)
    row: dict[str, Any] = {"w": w, "kd": kd, "diverged_at_s": result["diverged_at_s"]}
    phases = result["phases"]
    if result["diverged_at_s"] is not None:
        return row | dict.fromkeys(("first_task", "speed", "torque_rate", "jerk"))
    return row | {
        "first_task": max(phase["first"] for phase in phases),
        "speed": max(phase["speed"] for phase in phases),
        "torque_rate": max(phase["torque_rate"] for phase in phases[1:]),
        "jerk": phases[1]["jerk"],
    }


def table(result: dict[str, Any]) -> str:
    """One line per formulation, w and kd."""
    lines = [
        [
            name,
            *(f"{row[key]:g}" for key in ("w", "kd")),
            *(shown(row[key]) for key in ("first_task", "speed", "torque_rate", "jerk")),
        ]
        for name, rows in result["formulations"].items()
        for row in rows
    ]
    head = ["formulation", "w [-]", "kd [1/s]", "first task, worst phase [m, rad]"]
    head += ["mean abs(v), last 3 s, worst phase [rad/s]"]
    head += ["torque rate, phases 2 to 5 [Nm/s @ 1 ms]", "jerk integral, phase 2 [rad/s^2]"]
    return (
        "As in `phases`, with `regularization` w and `velocity_damping` kd. Defaults: w = 0.01, "
        "kd = 20 1/s.\n\n" + markdown_table(head, lines)
    )


def plot(result: dict[str, Any], path: Path) -> None:
    """One panel per figure against kd, one line per w; dotted: the goal."""
    figure = new_figure(9.6, 3.2)
    rows = result["formulations"][FORMULATIONS[0]]
    with styled():
        axes = figure.subplots(1, len(_PANELS))
        for ax, panel in zip(axes, _PANELS, strict=True):
            _draw(ax, rows, result["facts"]["w"], panel)
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5)
    save_png(figure, path)


def _draw(
    ax: Axes, rows: list[dict[str, Any]], w_values: list[float], panel: tuple[str, str, float]
) -> None:
    key, title, goal = panel
    for index, w in enumerate(w_values):
        mine = [row for row in rows if row["w"] == w and row[key] is not None]
        ax.plot(
            [row["kd"] for row in mine],
            [row[key] for row in mine],
            color=colour(index),
            marker="o",
            markersize=3.0,
            label=f"w = {w:g}",
        )
    ax.axhline(goal, color="#7F7F7F", lw=0.9, ls=":", label="goal")
    ax.set_yscale("log")
    ax.set_title(title)
    ax.set_xlabel("velocity_damping [1/s]")

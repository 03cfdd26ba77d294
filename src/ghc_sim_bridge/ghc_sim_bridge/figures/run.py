"""Figures of one run, similar to figures 2 to 10 of the GHC paper."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.task_errors import TaskHistory
from ghc_sim_bridge.figures.motion import jerk_figure, joints_figure
from ghc_sim_bridge.figures.style import (
    MOVES,
    colour,
    label_phases,
    mark_phases,
    new_figure,
    run_title,
    styled,
)
from ghc_sim_bridge.figures.tasks import alpha_panels, draw_alphas, tasks_figure
from ghc_sim_bridge.logs.controller_trace import ControllerTrace


def run_figures(analysis: Analysis, trace: ControllerTrace) -> dict[str, Figure]:
    """All figures for the available data of a run, by file stem."""
    with styled():
        figures = {
            "tasks": tasks_figure(analysis, trace),
            "joints": joints_figure(analysis),
            "jerk": jerk_figure(analysis),
        }
        for task in analysis.history.tasks:
            moves = task.unit == "m" and np.ptp(task.reference, axis=0).max() > MOVES
            if moves and task.reference.shape[1] == len("xyz"):
                figures[f"path_{task.name}"] = path_figure(analysis, task)
            if task.desired_force is not None and task.measured_force is not None:
                figures[f"force_{task.name}"] = force_figure(analysis, trace, task)
    return figures


def path_figure(analysis: Analysis, task: TaskHistory) -> Figure:
    """Desired and actual path of a frame while its task has the highest priority (figure 6)."""
    on_top = np.zeros(len(analysis.history.time), dtype=bool)
    for planned in analysis.plan.phases:
        if planned.phase.hierarchy.startswith(task.name):
            settled = planned.start + planned.ramp + 0.25 * planned.phase.hold
            inside = (analysis.history.time >= settled) & (analysis.history.time < planned.end)
            on_top |= inside
    figure = new_figure(9.0, 3.6)
    axes = figure.subplots(1, 3)
    shown = np.where(on_top[:, None], task.position, np.nan)
    for ax, (i, j) in zip(axes, ((0, 1), (0, 2), (1, 2)), strict=True):
        ax.plot(
            task.reference[:, i], task.reference[:, j], color="#BBBBBB", lw=4.0, label="desired"
        )
        ax.plot(shown[:, i], shown[:, j], color=colour(1), lw=1.2, label="resulting")
        ax.set_xlabel(f"{'xyz'[i]} [m]")
        ax.set_ylabel(f"{'xyz'[j]} [m]")
        ax.xaxis.set_major_locator(MaxNLocator(5))  # avoid overlapping labels
        ax.set_aspect("equal", adjustable="datalim")
    axes[0].legend(loc="upper left")
    largest = float(task.error[on_top].max(initial=0.0))
    figure.suptitle(
        f"{run_title(analysis)}\n{task.name} while its task is on top (from a quarter "
        f"of the phase on): largest error {largest:.2g} m",
        fontsize=10,
    )
    return figure


def force_figure(analysis: Analysis, trace: ControllerTrace, task: TaskHistory) -> Figure:
    """Priorities, position errors, desired and resulting contact force (figure 10)."""
    history = analysis.history
    figure = new_figure(9.0, 6.4)
    alphas, errors, force = figure.subplots(3, 1, sharex=True, height_ratios=[0.5, 1.5, 1.8])
    draw_alphas([alphas], alpha_panels(trace)[:1], trace)
    for index, other in enumerate(history.tasks):
        if other.unit == "m":
            suffix = " (in contact: within the plane)" if other is task else ""
            errors.plot(
                history.time,
                other.error,
                color=colour(index),
                label=f"{index + 1}: {other.name}{suffix}",
            )
    errors.set_ylabel("position error [m]")
    errors.legend(loc="upper right")
    _draw_forces(force, analysis, task)
    force.set_ylabel("force of the robot\non the plane [N]")
    force.set_xlabel("time [s]")
    for ax in (alphas, errors, force):
        mark_phases(ax, analysis.plan.phases)
    label_phases(alphas, analysis.plan.phases, [other.name for other in history.tasks])
    figure.suptitle(run_title(analysis), fontsize=10)
    return figure


def _draw_forces(ax: Axes, analysis: Analysis, task: TaskHistory) -> None:
    """Axes under force control: desired and measured forces."""
    assert task.desired_force is not None and task.contact is not None
    log = analysis.log
    for axis, name in enumerate("xyz"):
        desired = task.desired_force[:, axis]
        if np.abs(desired).max() == 0.0:
            continue
        force = -log.wrenches[task.contact][:, axis]  # the log stores the force on the robot
        ax.plot(log.time, force, color=colour(2), lw=1.0, label=f"resulting, {name}")
        ax.plot(
            analysis.history.time,
            desired,
            color="#000000",
            ls="--",
            lw=1.0,
            label=f"desired, {name}",
        )
        peak = int(np.abs(force).argmax())
        ax.annotate(
            f"largest: {force[peak]:.1f} N at {log.time[peak]:.2f} s",
            (log.time[peak], force[peak]),
            (8, 14),
            textcoords="offset points",
            fontsize=8,
        )
    ax.legend(loc="upper right")

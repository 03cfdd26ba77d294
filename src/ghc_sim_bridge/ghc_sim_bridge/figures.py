"""Figures of one run, in the manner of the GHC paper's figures 2 to 10."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray

from ghc_sim_bridge.analysis import Analysis
from ghc_sim_bridge.controller_trace import ControllerTrace
from ghc_sim_bridge.figure_style import (
    colour,
    envelope,
    label_phases,
    mark_phases,
    new_figure,
    styled,
)
from ghc_sim_bridge.metrics import jerk_steps, torque_jumps
from ghc_sim_bridge.task_errors import TaskHistory

Array = NDArray[np.float64]

_SMALLEST_ERROR = 1e-8  # lower end of logarithmic axes
_NAMED_JOINTS = 7  # in the legend of a figure
_MANY_TASKS = 4  # more of them: only priorities that change are drawn
_MOVES = 1e-6  # [m] a reference that stays within this is static


def run_figures(analysis: Analysis, trace: ControllerTrace) -> dict[str, Figure]:
    """All figures that a run has data for, by the stem of their file."""
    with styled():
        figures = {
            "tasks": tasks_figure(analysis, trace),
            "joints": joints_figure(analysis),
            "jerk": jerk_figure(analysis),
        }
        for task in analysis.history.tasks:
            if task.unit == "m" and np.ptp(task.reference, axis=0).max() > _MOVES:
                figures[f"path_{task.name}"] = path_figure(analysis, task)
            if task.desired_force is not None and task.measured_force is not None:
                figures[f"force_{task.name}"] = force_figure(analysis, trace, task)
    return figures


def tasks_figure(analysis: Analysis, trace: ControllerTrace) -> Figure:
    """Priorities at the top, task errors below, linear and logarithmic (figures 2 to 4, 7)."""
    pairs = alpha_panels(trace)
    figure = new_figure(9.0, 4.6 + 0.62 * len(pairs))
    axes = figure.subplots(
        len(pairs) + 2, 1, sharex=True, height_ratios=[0.45] * len(pairs) + [1.5, 1.5]
    )
    _draw_alphas(axes[: len(pairs)], pairs, trace)
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
    figure.suptitle(_title(analysis), fontsize=10)
    return figure


def _fastest(speeds: Array) -> set[int]:
    """The joints that a legend has room for: those with the largest peak speeds (T, n)."""
    order = np.argsort(-np.abs(speeds).max(axis=0), kind="stable")
    return {int(index) for index in order[:_NAMED_JOINTS]}


def joints_figure(analysis: Analysis) -> Figure:
    """Velocities and torques with their bounds, and the torque rate (figure 8)."""
    log, limits, history = analysis.log, analysis.limits, analysis.history
    figure = new_figure(9.0, 7.2)
    velocity, torque, rate = figure.subplots(3, 1, sharex=True)
    named = _fastest(log.v)
    for index, name in enumerate(log.joint_names):
        velocity.plot(
            history.time,
            log.v[history.rows, index],
            color=colour(index),
            label=name if index in named else None,
        )
    _draw_bounds(velocity, log.v, limits.velocity)
    velocity.set_ylabel("joint velocity [rad/s]")
    velocity.legend(
        ncols=len(named),
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        columnspacing=1.0,
        handlelength=1.2,
    )
    shown, bound = log.torque[history.rows], limits.torque
    label = "joint torque [Nm]"
    if limits.torque_bound is not None:
        bound = limits.torque_bound
        if limits.bound_around_gravity:
            shown, label = shown - history.gravity, "torque - gravity [Nm]"
    for index in range(shown.shape[1]):
        torque.plot(history.time, shown[:, index], color=colour(index))
    _draw_bounds(torque, shown, bound)
    torque.set_ylabel(label)
    block = max(1, round(0.01 / log.control_dt))
    rates = torque_jumps(log.torque) / log.control_dt
    rate.semilogy(*envelope(log.time, np.maximum(rates, 1e-2), block), color="#000000", lw=0.8)
    if limits.torque_rate > 0.0:
        rate.axhline(limits.torque_rate, color="#D55E00", ls="--", lw=1.0)
        rate.annotate(
            "rate limit",
            (0.0, limits.torque_rate),
            (4, 3),
            color="#D55E00",
            textcoords="offset points",
            fontsize=8,
        )
    rate.set_ylabel(f"largest torque rate [Nm/s]\nat a period of {1e3 * log.control_dt:g} ms")
    rate.set_xlabel("time [s]")
    for ax in (velocity, torque, rate):
        mark_phases(ax, analysis.plan.phases)
    figure.suptitle(_title(analysis), fontsize=10)
    return figure


def jerk_figure(analysis: Analysis) -> Figure:
    """Integral of the absolute joint jerks over time, summed over the joints (figure 5)."""
    log = analysis.log
    figure = new_figure(9.0, 3.2)
    ax = figure.subplots()
    ax.plot(log.time[::10], np.cumsum(jerk_steps(log.acceleration))[::10], color=colour(0))
    ax.set_ylim(bottom=0.0)
    ax.set_ylabel("integral of |jerk|,\nsum of the joints [rad/s$^2$]")
    ax.set_xlabel("time [s]")
    mark_phases(ax, analysis.plan.phases)
    label_phases(ax, analysis.plan.phases, [task.name for task in analysis.history.tasks])
    figure.suptitle(_title(analysis), fontsize=10)
    return figure


def path_figure(analysis: Analysis, task: TaskHistory) -> Figure:
    """Desired and resulting path of a frame while its task is on top (figure 6)."""
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
        ax.set_aspect("equal", adjustable="datalim")
    axes[0].legend(loc="upper left")
    largest = float(task.error[on_top].max(initial=0.0))
    figure.suptitle(
        f"{_title(analysis)}\n{task.name} while its task is on top (from a quarter "
        f"of the phase on): largest error {largest:.2g} m",
        fontsize=10,
    )
    return figure


def force_figure(analysis: Analysis, trace: ControllerTrace, task: TaskHistory) -> Figure:
    """Priorities, position errors, desired and resulting contact force (figure 10)."""
    history = analysis.history
    figure = new_figure(9.0, 6.4)
    alphas, errors, force = figure.subplots(3, 1, sharex=True, height_ratios=[0.5, 1.5, 1.8])
    _draw_alphas([alphas], alpha_panels(trace)[:1], trace)
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
    figure.suptitle(_title(analysis), fontsize=10)
    return figure


def _draw_forces(ax: Axes, analysis: Analysis, task: TaskHistory) -> None:
    """Axes under force control: what was desired, and every sample of what resulted."""
    assert task.desired_force is not None and task.contact is not None
    log = analysis.log
    for axis, name in enumerate("xyz"):
        desired = task.desired_force[:, axis]
        if np.abs(desired).max() == 0.0:
            continue
        force = -log.wrenches[task.contact][:, axis]  # the log has that on the robot
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


def _title(analysis: Analysis) -> str:
    plan = analysis.plan
    ramp = f"transitions of {plan.transition:g} s" if plan.transition else "switched at once"
    period = f"control period {1e3 * analysis.log.control_dt:g} ms"
    return f"{plan.scenario.title} ({plan.formulation}, {ramp}, {period})"


def alpha_panels(trace: ControllerTrace) -> list[list[tuple[int, int]]]:
    """One panel for each pair of tasks, and one for the removals where there are any.

    Of many tasks only those whose priority changes; the first pair where nothing does.
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


def _draw_alphas(
    axes: Sequence[Axes], panels: list[list[tuple[int, int]]], trace: ControllerTrace
) -> None:
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
    """Errors on linear axes: metres at the left, radians at the right."""
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


def _draw_bounds(ax: Axes, values: Array, bound: Array) -> None:
    """Bounds that are in sight as lines; of the others only how near the values come."""
    reach = np.abs(values).max(axis=0)
    tight = float(bound.min())
    if np.allclose(bound, tight) and tight <= 2.0 * reach.max():
        for side in (-tight, tight):
            ax.axhline(side, color="#000000", ls="--", lw=1.0)
        ax.set_ylim(-1.15 * tight, 1.15 * tight)
        note = f"bounds \u00b1{tight:g}"
    else:
        note = f"at most {100.0 * float((reach / bound).max()):.0f} % of a joint's limit"
    ax.annotate(
        note,
        (1.0, 1.0),
        (-4, 2),
        xycoords="axes fraction",
        textcoords="offset points",
        ha="right",
        va="bottom",
        fontsize=8,
    )

"""Joints and their jerk of one run (GHC paper, figures 5 and 6)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ghc_controller.types import Array
from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.metrics import jerk_steps, torque_jumps
from ghc_sim_bridge.figures.style import (
    colour,
    envelope,
    label_phases,
    mark_phases,
    new_figure,
    run_title,
)

_NAMED_JOINTS = 7  # in the legend of a figure


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
    figure.suptitle(run_title(analysis), fontsize=10)
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
    figure.suptitle(run_title(analysis), fontsize=10)
    return figure


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

"""Joint motion and jerk of one run (GHC paper, figures 5 and 8)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ghc_controller.types import Array
from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.metrics import jerk_steps, torque_jumps
from ghc_sim_bridge.colors import BOUND, dashes
from ghc_sim_bridge.figures.style import (
    colour,
    envelope,
    label_phases,
    mark_phases,
    new_figure,
    run_title,
)

_LEGEND_WIDTH = 110  # letters in a row of a legend
_ROW = 0.17  # [inch] height of a row of a legend
_PANEL = 2.2  # [inch] height of a panel


def joints_figure(analysis: Analysis) -> Figure:
    """Velocities and torques with their bounds, and the torque rate (figure 8).

    Prismatic joints have separate panels, in m/s and N.
    """
    log, limits, history = analysis.log, analysis.limits, analysis.history
    turning, sliding = joints_by_kind(analysis)
    kinds = [
        (joints, units) for joints, units in ((turning, _TURNING), (sliding, _SLIDING)) if joints
    ]
    columns = _legend_columns(log.joint_names)
    rows = -(-len(log.joint_names) // columns)
    count = 2 * len(kinds) + 1
    figure = new_figure(9.0, _PANEL * count + 0.6 + _ROW * rows)
    axes = list(figure.subplots(count, 1, sharex=True))
    shown, bound, of = log.torque[history.rows], limits.torque, "joint"
    if limits.torque_bound is not None:
        bound = limits.torque_bound
        if limits.bound_around_gravity:
            shown, of = shown - history.gravity, "(minus gravity) joint"
    for ax, (joints, units) in zip(axes, kinds, strict=False):
        _draw_joints(ax, history.time, log.v[history.rows], joints)
        _draw_bounds(ax, log.v[:, joints], limits.velocity[joints])
        ax.set_ylabel(f"joint velocity [{units.velocity}]")
    for ax, (joints, units) in zip(axes[len(kinds) :], kinds, strict=False):
        _draw_joints(ax, history.time, shown, joints)
        _draw_bounds(ax, shown[:, joints], bound[joints])
        ax.set_ylabel(f"{of} {units.effort_name} [{units.effort}]")
    _draw_rate(axes[-1], analysis, " or ".join(f"{units.effort}/s" for _, units in kinds))
    axes[-1].set_xlabel("time [s]")
    for ax in axes:
        mark_phases(ax, analysis.plan.phases)
    figure.legend(
        [_line(index) for index in range(len(log.joint_names))],
        log.joint_names,
        loc="outside lower center",
        ncols=columns,
        columnspacing=1.0,
        handlelength=2.2,
    )
    figure.suptitle(run_title(analysis), fontsize=10)
    return figure


class _Units(NamedTuple):
    velocity: str
    effort: str
    effort_name: str


_TURNING, _SLIDING = _Units("rad/s", "Nm", "torque"), _Units("m/s", "N", "force")


def joints_by_kind(analysis: Analysis) -> tuple[list[int], list[int]]:
    """Indices in the log of revolute joints, and of prismatic joints."""
    model = analysis.robot.model
    turns = np.abs(model.angular_axes()[:, model.nv - model.na :]).max(axis=0) > 0.0
    of_log = [bool(turns[model.joint_index(name)]) for name in analysis.log.joint_names]
    return (
        [place for place, turns_ in enumerate(of_log) if turns_],
        [place for place, turns_ in enumerate(of_log) if not turns_],
    )


def _legend_columns(names: Sequence[str]) -> int:
    """Number of legend columns that fit side by side."""
    return max(1, min(len(names), _LEGEND_WIDTH // (max(map(len, names)) + 6)))


def _line(index: int) -> Line2D:
    """Sample of a joint's curve."""
    return Line2D([], [], color=colour(index), linestyle=dashes(index))


def _draw_joints(ax: Axes, time: Array, values: Array, joints: Sequence[int]) -> None:
    """Draw the curves of some joints, each in its color; `values` (S, n)."""
    for joint in joints:
        ax.plot(time, values[:, joint], color=colour(joint), linestyle=dashes(joint))


def _draw_rate(ax: Axes, analysis: Analysis, unit: str) -> None:
    """The largest torque rate of all joints, and its limit."""
    log, limit = analysis.log, analysis.limits.torque_rate
    block = max(1, round(0.01 / log.control_dt))
    rates = torque_jumps(log.torque) / log.control_dt
    ax.semilogy(*envelope(log.time, np.maximum(rates, 1e-2), block), color="#000000", lw=0.8)
    if limit > 0.0:
        ax.axhline(limit, color=BOUND, ls="--", lw=1.0)
        ax.annotate(
            "rate limit",
            (0.0, limit),
            (4, 3),
            color=BOUND,
            textcoords="offset points",
            fontsize=8,
        )
    ax.set_ylabel(f"largest torque rate\n[{unit}] at {1e3 * log.control_dt:g} ms")


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
    """Draw bounds near the values as lines; for others, note how close the values come."""
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

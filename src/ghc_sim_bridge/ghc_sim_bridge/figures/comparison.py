"""Figures that compare runs: jerk (figure 5), torque rates, torques, task errors (figure 11)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ghc_controller.types import Array
from ghc_sim_bridge.analysis.analysis import Analysis
from ghc_sim_bridge.analysis.metrics import jerk_steps
from ghc_sim_bridge.figures.style import colour, new_figure, short_hierarchy, styled
from ghc_sim_bridge.logs.full_rate_log import FullRateLog

Summary = Mapping[str, Any]

_SMALLEST_JERK = 10.0  # [rad/s^2] lower end of the logarithmic axis
_AROUND = (-0.5, 3.0)  # [s] of a switch


def jerk_comparison(runs: Mapping[str, tuple[Summary, FullRateLog]]) -> Figure:
    """Integral of |jerk| over the phases, one curve per run (figure 5 of the GHC paper).

    The axis counts phases, since those of runs that switch at once are shorter.
    """
    with styled():
        figure = new_figure(9.0, 4.0)
        ax = figure.subplots()
        for index, (name, (summary, log)) in enumerate(runs.items()):
            integral = np.cumsum(jerk_steps(log.acceleration))
            where = _phase_axis(log.time, summary["phases"])
            ax.semilogy(
                where[::20],
                np.maximum(integral[::20], _SMALLEST_JERK),
                color=colour(index),
                label=f"{name}: {integral[-1]:.0f}",
            )
        summary = next(iter(runs.values()))[0]
        _mark_phase_axis(ax, summary)
        ax.set_ylim(bottom=_SMALLEST_JERK)
        ax.set_ylabel("integral of |jerk|,\nsum of the joints [rad/s$^2$]")
        figure.legend(
            loc="outside right upper", title="run: at the end [rad/s$^2$]", title_fontsize=8
        )
        return figure


def rate_comparison(summaries: Mapping[str, Summary]) -> Figure:
    """Largest torque rate of each phase, one bar per run."""
    with styled():
        figure = new_figure(9.0, 3.6)
        ax = figure.subplots()
        width = 0.8 / len(summaries)
        for index, (name, summary) in enumerate(summaries.items()):
            rates = np.array(summary["peak_torque_rate_nm_per_s"]["per_phase"])
            places = np.arange(len(rates)) + 0.1 + (index + 0.5) * width
            ax.bar(places, rates, width, color=colour(index), label=name)
        ax.set_yscale("log")
        summary = next(iter(summaries.values()))
        _mark_phase_axis(ax, summary)
        ax.set_ylabel(
            f"largest torque rate [Nm/s]\nat a period of {1e3 * summary['control_dt_s']:g} ms"
        )
        figure.legend(loc="outside right upper")
        return figure


def torque_comparison(runs: Mapping[str, tuple[Summary, FullRateLog]], phase: int = 1) -> Figure:
    """Applied joint torques around the switch to a phase, one panel per run on shared axes."""
    with styled():
        figure = new_figure(9.0, 3.0)
        panels = np.atleast_1d(figure.subplots(1, len(runs), sharex=True, sharey=True))
        for ax, (name, (summary, log)) in zip(panels, runs.items(), strict=True):
            time = log.time - summary["phases"][phase]["t_start"]
            shown = (time >= _AROUND[0]) & (time <= _AROUND[1])
            for joint, torque in enumerate(log.torque[shown].T):
                ax.plot(time[shown], torque, color=colour(joint), label=log.joint_names[joint])
            rate = summary["peak_torque_rate_nm_per_s"]["per_phase"][phase]
            period = 1e3 * summary["control_dt_s"]
            ax.set_title(f"{name}: {rate:.0f} Nm/s at {period:g} ms")
            ax.set_xlabel("time since the switch [s]")
            ax.set_xlim(*_AROUND)
        panels[0].set_ylabel("joint torque [Nm]")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right center")
        return figure


def variants_comparison(analyses: Mapping[str, Analysis]) -> Figure:
    """Position errors of a scenario's variants side by side (figure 11), by their titles."""
    with styled():
        figure = new_figure(9.0, 3.6)
        axes = figure.subplots(1, len(analyses), sharey=True)
        for ax, (title, analysis) in zip(np.atleast_1d(axes), analyses.items(), strict=True):
            for index, task in enumerate(analysis.history.tasks):
                if task.unit != "m":
                    continue
                ax.plot(
                    analysis.history.time,
                    task.error,
                    color=colour(index),
                    label=f"{task.name}: {task.error[-1]:.3f} m",
                )
            ax.set_title(title)
            ax.set_xlabel("time [s]")
            ax.set_xlim(0.0, analysis.history.time[-1])
            ax.legend(loc="upper right", title="error at the end", title_fontsize=8)
        first = np.atleast_1d(axes)[0]
        first.set_ylim(0.0, 1.25 * first.get_ylim()[1])  # room for the legends
        first.set_ylabel("task error [m]")
        return figure


def _phase_axis(time: Array, phases: Sequence[Mapping[str, Any]]) -> Array:
    """Times [s] as completed phases: 1.5 = half of the second phase is over."""
    edges = [phases[0]["t_start"], *(phase["t_end"] for phase in phases)]
    return np.interp(time, edges, np.arange(len(edges)))


def _mark_phase_axis(ax: Axes, summary: Summary) -> None:
    phases = summary["phases"]
    tasks = list(summary["error_units"])
    labels = [short_hierarchy(phase["hierarchy"], tasks) for phase in phases]
    ax.set_xlim(0.0, len(phases))
    ax.set_xticks(np.arange(len(phases)) + 0.5, labels)
    ax.grid(visible=False, axis="x")
    for edge in range(1, len(phases)):
        ax.axvline(edge, color="#999999", lw=0.6)
    ax.set_xlabel("phase")

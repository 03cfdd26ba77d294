"""Figure of two runs with raw and smoothed bounds (thesis, figures 4.10, 5.12, 5.13)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ghc_sim_bridge.analysis.generator_analysis import GeneratorAnalysis
from ghc_sim_bridge.analysis.limit_history import LimitHistory
from ghc_sim_bridge.analysis.metrics import torque_jumps
from ghc_sim_bridge.analysis.task_errors import TaskHistory
from ghc_sim_bridge.colors import BOUND, MEASURED, SHOWN
from ghc_sim_bridge.figures.style import MOVES, colour, envelope, new_figure, styled
from ghc_sim_bridge.logs.constraint_series import FORCE, LOWER, UPPER

_SMALLEST_RATE = 1e-1  # [Nm/s] lower end of the logarithmic axis


def generator_figure(off: GeneratorAnalysis, on: GeneratorAnalysis) -> Figure:
    """Bounds and bounded quantities, joint torques, torque rates; one column per run."""
    rows = [
        *((_draw_force, name) for name in on.forces),
        *((_draw_distance, name) for name in on.distances),
        *((_draw_path, task.name) for task in _moving(on)),
        *((_draw_limit, name) for name in on.limits),
        (_draw_torques, ""),
        (_draw_rates, ""),
    ]
    with styled():
        figure = new_figure(10.0, 2.1 * len(rows) + 0.6)
        axes = figure.subplots(len(rows), 2, sharex=True, sharey="row", squeeze=False)
        for column, (run, title) in enumerate(
            ((off, "raw bounds (generators off)"), (on, "smoothed bounds (generators on)"))
        ):
            for (draw, name), ax in zip(rows, axes[:, column], strict=True):
                draw(ax, run, name)
                _mark_events(ax, run)
                ax.tick_params(labelleft=True)
            axes[0, column].set_title(title)
            axes[-1, column].set_xlabel("time [s]")
        for ax in axes[:, 1]:
            ax.set_ylabel("")
        for ax in axes[:-2, 1]:
            ax.legend(loc="best")
        plan = on.analysis.plan
        figure.suptitle(
            f"{plan.scenario.title} ({plan.formulation}, control period "
            f"{1e3 * plan.control_dt:g} ms)",
            fontsize=10,
        )
    return figure


def _draw_force(ax: Axes, run: GeneratorAnalysis, name: str) -> None:
    if name not in run.forces:
        return
    time, values = run.series.time, run.series.contacts[name]
    ax.plot(run.analysis.log.time, run.forces[name], color=MEASURED, lw=0.8, label="simulated")
    ax.plot(time, values[:, FORCE], color=SHOWN, lw=1.4, label="commanded (QP)")
    ax.plot(time, values[:, UPPER], color=BOUND, ls="--", lw=1.0, label="current bounds")
    ax.plot(time, values[:, LOWER], color=BOUND, ls="--", lw=1.0)
    largest = float(np.nanmax(values[:, FORCE], initial=1.0))
    ax.set_ylim(-0.08 * largest, 1.5 * largest)
    ax.set_ylabel(f"normal force of\ncontact {name} [N]")


def _draw_distance(ax: Axes, run: GeneratorAnalysis, name: str) -> None:
    if name not in run.distances:
        return
    history = run.distances[name]
    ax.plot(history.time, history.actual, color=MEASURED, lw=1.0, label="to the obstacle itself")
    ax.plot(history.time, history.virtual, color=SHOWN, label="to that of the controller")
    ax.plot(history.time, history.safe_distance, color="#000000", ls="--", lw=1.0, label="safe")
    safe = float(history.safe_distance.max(initial=0.0))
    ax.set_ylim(0.5 * safe, 2.2 * safe)
    ax.set_ylabel(f"distance to\n{name} [m]")


def _draw_limit(ax: Axes, run: GeneratorAnalysis, name: str) -> None:
    if name not in run.limits:
        return
    history, joint = run.limits[name], name.split("/", 1)[1]
    if history.unit == "m":
        _draw_margin(ax, history, joint)
        return
    what = "position" if history.unit == "rad" else "torque"
    for side, (raw, moving) in ((UPPER, ("raw", "in force")), (LOWER, (None, None))):
        edges = history.raw[:, side]
        ax.step(history.time, edges, color="#BBBBBB", lw=2.5, where="post", label=raw)
        limit = history.limits[:, side]
        ax.plot(history.time, limit, color=colour(1), ls="--", lw=1.0, label=moving)
    ax.plot(history.time, history.value, color=colour(0), label=what)
    ax.set_ylabel(f"{what} of\n{joint} [{history.unit}]")


def _draw_margin(ax: Axes, history: LimitHistory, name: str) -> None:
    raw, margin = history.raw[:, LOWER], history.limits[:, LOWER]
    ax.step(history.time, raw, color="#BBBBBB", lw=2.5, where="post", label="raw margin")
    ax.plot(history.time, margin, color=colour(1), ls="--", lw=1.0, label="margin in force")
    ax.plot(history.time, history.value, color=colour(0), label="least distance")
    ax.set_ylim(min(0.0, float(history.value.min())) - 0.02, 1.6 * float(history.value.max()))
    ax.set_ylabel(f"distance of\n{name} [m]")


def _draw_path(ax: Axes, run: GeneratorAnalysis, name: str) -> None:
    history = run.analysis.history
    task = next(task for task in history.tasks if task.name == name)
    for axis in range(task.position.shape[1]):
        ax.plot(history.time, task.reference[:, axis], color="#BBBBBB", lw=2.5)
        ax.plot(history.time, task.position[:, axis], color=colour(axis), label="xyz"[axis])
    ax.set_ylabel(f"{name} [m]\n(wide: reference)")


def _draw_torques(ax: Axes, run: GeneratorAnalysis, _name: str) -> None:
    log, history = run.analysis.log, run.analysis.history
    for joint in range(log.torque.shape[1]):
        ax.plot(history.time, log.torque[history.rows, joint], color=colour(joint))
    ax.set_ylabel("joint torques [Nm]")


def _draw_rates(ax: Axes, run: GeneratorAnalysis, _name: str) -> None:
    log = run.analysis.log
    rates = np.maximum(torque_jumps(log.torque) / log.control_dt, _SMALLEST_RATE)
    block = max(1, round(0.01 / log.control_dt))
    ax.semilogy(*envelope(log.time, rates, block), color="#000000", lw=0.8)
    for (start, end), peak in zip(run.windows, run.peaks, strict=True):
        ax.plot([start, end], [peak, peak], color=BOUND, lw=1.4)
        ax.annotate(
            f"{peak:.3g}",
            (0.5 * (start + end), peak),
            (0, 3),
            textcoords="offset points",
            ha="center",
            color=BOUND,
            fontsize=8,
        )
    ax.set_ylabel("largest torque rate\nof a joint [Nm/s]")


def _mark_events(ax: Axes, run: GeneratorAnalysis) -> None:
    for event in run.analysis.plan.scenario.events:
        ax.axvline(event.time, color="#999999", lw=0.8, ls=":", zorder=0)
    ax.set_xlim(0.0, run.analysis.plan.duration)


def _moving(run: GeneratorAnalysis) -> list[TaskHistory]:
    """Position tasks with a moving reference, in runs with obstacles."""
    if not run.distances:
        return []
    return [
        task
        for task in run.analysis.history.tasks
        if task.unit == "m" and np.ptp(task.reference, axis=0).max() > MOVES
    ]

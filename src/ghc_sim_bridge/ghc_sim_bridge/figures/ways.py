"""Figure of strategies to release a contact, one per column (thesis, figures 5.15 and 5.16)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ghc_sim_bridge.analysis.generator_analysis import GeneratorAnalysis
from ghc_sim_bridge.colors import BOUND, MEASURED, SHOWN
from ghc_sim_bridge.figures.style import colour, new_figure, styled
from ghc_sim_bridge.logs.constraint_series import FORCE, UPPER

_REACH = 1.5  # [s] shown before and after the events


def ways_figure(ways: Mapping[str, GeneratorAnalysis]) -> Figure:
    """Normal force of the first contact with a schedule, if any; torques of the watched joints."""
    plan = next(iter(ways.values())).analysis.plan
    contacts = [_scheduled_contact(run) for run in ways.values()]
    contact = next((name for name in contacts if name is not None), None)
    rows = 2 if contact is None else 3
    times = [event.time for event in plan.scenario.events] or [0.0, plan.duration]
    span = (max(0.0, min(times) - _REACH), min(plan.duration, max(times) + _REACH))
    with styled():
        figure = new_figure(3.6 * len(ways) + 0.6, 2.0 * rows + 0.6)
        axes = figure.subplots(rows, len(ways), sharex=True, sharey="row", squeeze=False)
        for column, (title, run) in enumerate(ways.items()):
            if contact is not None:
                _draw_force(axes[0, column], run)
            _draw_torques(axes[-2, column], run, plan.scenario.watched_joints)
            _draw_rates(axes[-1, column], run, plan.scenario.watched_joints, span)
            axes[0, column].set_title(title)
            axes[-1, column].set_xlabel("time [s]")
            for ax in axes[:, column]:
                ax.set_xlim(*span)
                for event in plan.scenario.events:
                    ax.axvline(event.time, color="#999999", lw=0.8, ls=":", zorder=0)
                ax.tick_params(labelleft=True)
        if contact is not None:
            axes[0, 0].set_ylabel(f"normal force of\ncontact {contact} [N]")
            axes[0, -1].legend(loc="best")
        axes[-2, 0].set_ylabel("joint torque [Nm]")
        axes[-1, 0].set_ylabel("torque rate [Nm/s]")
        axes[-2, -1].legend(loc="best")
        figure.suptitle(
            f"{plan.scenario.title} ({plan.formulation}, control period "
            f"{1e3 * plan.control_dt:g} ms)",
            fontsize=10,
        )
    return figure


def _scheduled_contact(run: GeneratorAnalysis) -> str | None:
    """The first contact with a schedule; None if the scenario has no schedules."""
    schedules = run.analysis.plan.scenario.contact_schedules
    return schedules[0].contact if schedules else None


def _draw_force(ax: Axes, run: GeneratorAnalysis) -> None:
    name = _scheduled_contact(run)
    if name is None or name not in run.forces:
        return
    time, values = run.series.time, run.series.contacts[name]
    ax.plot(run.analysis.log.time, run.forces[name], color=MEASURED, lw=0.8, label="simulated")
    ax.plot(time, values[:, FORCE], color=SHOWN, lw=1.4, label="commanded (QP)")
    ax.plot(time, values[:, UPPER], color=BOUND, ls="--", lw=1.0, label="upper bound")


def _draw_torques(ax: Axes, run: GeneratorAnalysis, joints: Sequence[str]) -> None:
    log = run.analysis.log
    for k, name in enumerate(joints):
        torque = log.torque[:, log.joint_names.index(name)]
        ax.plot(log.time, torque, color=colour(k), ls="-" if k == 0 else "--", label=name)


def _draw_rates(
    ax: Axes, run: GeneratorAnalysis, joints: Sequence[str], span: tuple[float, float]
) -> None:
    log = run.analysis.log
    for k, name in enumerate(joints):
        rate = np.diff(log.torque[:, log.joint_names.index(name)]) / log.control_dt
        ax.plot(log.time[1:], rate, color=colour(k), ls="-" if k == 0 else "--", lw=0.9)
        if k == 0:
            shown = (log.time[1:] >= span[0]) & (log.time[1:] <= span[1])
            peak = int(np.argmax(np.where(shown, np.abs(rate), -1.0)))
            place = (log.time[1 + peak], rate[peak])
            ax.annotate(
                f"{rate[peak]:.3g}",
                place,
                (6, 0),
                textcoords="offset points",
                va="center",
                color=BOUND,
                fontsize=8,
            )

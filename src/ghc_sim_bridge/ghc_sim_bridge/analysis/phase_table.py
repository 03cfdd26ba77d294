"""The table of the phases that a run prints at its end."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ghc_sim_bridge.analysis.rest import rest_line
from ghc_sim_bridge.analysis.text_table import aligned

MOST_COLUMNS = 4  # of tasks: more of them are shown as rows
_ROUNDING = 1e-6  # relative excess of a limit that is not worth a word


def phase_table(summary: Mapping[str, Any]) -> str:
    """Hierarchy, task errors at the end, peak torque rate and jerk integral of each phase."""
    units = summary["error_units"]
    if len(units) > MOST_COLUMNS:
        return _tasks_as_rows(summary)
    period = 1e3 * summary["control_dt_s"]
    head = [
        "phase",
        "hierarchy",
        "from [s]",
        "to [s]",
        *(f"{task} [{unit}]" for task, unit in units.items()),
        f"torque rate [Nm/s @ {period:g} ms]",
        "jerk integral [rad/s^2]",
    ]
    rows = []
    for index, phase in enumerate(summary["phases"]):
        rows.append(
            [
                str(index + 1),
                phase["hierarchy"],
                f"{phase['t_start']:g}",
                f"{phase['t_end']:g}",
                *(f"{phase['errors'][task]:.2e}" for task in units),
                f"{summary['peak_torque_rate_nm_per_s']['per_phase'][index]:.0f}",
                f"{summary['jerk_integral']['per_phase'][index]:.1f}",
            ]
        )
    return aligned(head, rows, left=(1,))


def _tasks_as_rows(summary: Mapping[str, Any]) -> str:
    """One column for each phase: fits a terminal however many tasks there are."""
    units, phases = summary["error_units"], summary["phases"]
    rates = summary["peak_torque_rate_nm_per_s"]["per_phase"]
    jerks = summary["jerk_integral"]["per_phase"]
    hierarchies = [f"phase {k + 1}: {phase['hierarchy']}" for k, phase in enumerate(phases)]
    rows = [
        ["from [s]", *(f"{phase['t_start']:g}" for phase in phases)],
        ["to [s]", *(f"{phase['t_end']:g}" for phase in phases)],
        *(
            [f"{task} [{unit}]", *(f"{phase['errors'][task]:.2e}" for phase in phases)]
            for task, unit in units.items()
        ),
        [
            f"torque rate [Nm/s @ {1e3 * summary['control_dt_s']:g} ms]",
            *(f"{rate:.0f}" for rate in rates),
        ],
        ["jerk integral [rad/s^2]", *(f"{jerk:.1f}" for jerk in jerks)],
    ]
    head = ["errors at the end of phase", *(str(k + 1) for k in range(len(phases)))]
    return "\n".join([*hierarchies, aligned(head, rows, left=(0,))])


def outcome_lines(summary: Mapping[str, Any]) -> str:
    """What went wrong, or that nothing did, and how long it took."""
    excess = summary["limit_violations"].items()
    worst = {name: value for name, value in excess if value > _ROUNDING}
    limits = ", ".join(f"{name} {100.0 * value:.2g} %" for name, value in worst.items())
    failed = {name: code for name, code in summary["nodes"].items() if code != 0}
    nodes = ", ".join(f"{name} {code}" for name, code in failed.items())
    left = rest_line(summary)
    return "\n".join(
        [
            *([left] if left else []),
            f"limits exceeded: {limits or 'none'}; qp failures: {summary['qp_failures']}, "
            f"fallback ticks: {summary['fallback_ticks']}, gated ticks: {summary['gated_ticks']}",
            f"exit codes: {nodes or 'all nodes 0'}; {summary['sim_seconds']:g} s simulated in "
            f"{summary['wall_seconds']:.1f} s ({summary['real_time_factor']:.2f} x real time)",
        ]
    )

"""The table of the phases that a run prints at its end."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ghc_sim_bridge.text_table import aligned

_ROUNDING = 1e-6  # relative excess of a limit that is not worth a word


def phase_table(summary: Mapping[str, Any]) -> str:
    """Hierarchy, task errors at the end, peak torque rate and jerk integral of each phase."""
    units = summary["error_units"]
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


def outcome_lines(summary: Mapping[str, Any]) -> str:
    """What went wrong, or that nothing did, and how long it took."""
    excess = summary["limit_violations"].items()
    worst = {name: value for name, value in excess if value > _ROUNDING}
    limits = ", ".join(f"{name} {100.0 * value:.2g} %" for name, value in worst.items())
    failed = {name: code for name, code in summary["nodes"].items() if code != 0}
    nodes = ", ".join(f"{name} {code}" for name, code in failed.items())
    return "\n".join(
        [
            f"limits exceeded: {limits or 'none'}; qp failures: {summary['qp_failures']}, "
            f"fallback ticks: {summary['fallback_ticks']}, gated ticks: {summary['gated_ticks']}",
            f"exit codes: {nodes or 'all nodes 0'}; {summary['sim_seconds']:g} s simulated in "
            f"{summary['wall_seconds']:.1f} s ({summary['real_time_factor']:.2f} x real time)",
        ]
    )

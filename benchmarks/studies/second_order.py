"""The second-order term of the tasks at torque level, with and without velocity damping."""

from __future__ import annotations

from typing import Any

import ghc_controller as ghc
from benchmarks.study_results import shown
from benchmarks.switching_loop import Timing, run_phases
from benchmarks.unreachable_loop import run_unreachable
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "second_order"
TITLE = "KUKA, second-order terms of the tasks"
FORMULATIONS = ("balanced", "cascade")
_KD = (0.0, 10.0, 20.0)  # [1/s]
_UNREACHABLE = 8.0  # [s]
_QUICK_TIMING = Timing(ramp=0.02, hold=0.03)
_QUICK_UNREACHABLE = 0.05  # [s]


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Two closed loops per formulation, kd, and with or without the term."""
    timing = _QUICK_TIMING if quick else Timing()
    duration = _QUICK_UNREACHABLE if quick else _UNREACHABLE
    found = {
        name: [
            _run(name, second_order, kd, timing, duration)
            for kd in _KD
            for second_order in (False, True)
        ]
        for name in formulations
    }
    return {"facts": {"kd": _KD, "unreachable_s": duration, "quick": quick}, "formulations": found}


def _run(
    name: str, second_order: bool, kd: float, timing: Timing, duration: float
) -> dict[str, Any]:
    settings = ghc.FormulationSettings(velocity_damping=kd, second_order=second_order)
    switching = run_phases(name, settings, timing)
    row: dict[str, Any] = {"second_order": second_order, "kd": kd}
    phases = switching["phases"]
    complete = switching["diverged_at_s"] is None
    for key in ("first", "speed"):
        row[key] = max(phase[key] for phase in phases) if complete else None
    row["torque_rate"] = max(p["torque_rate"] for p in phases[1:]) if complete else None
    row["jerk"] = phases[1]["jerk"] if complete else None
    return row | {"unreachable": run_unreachable(name, settings, duration)}


def table(result: dict[str, Any]) -> str:
    """One line per formulation, kd, and with or without the term."""
    lines = []
    for name, rows in result["formulations"].items():
        for row in rows:
            far = row["unreachable"]
            lines.append(
                [
                    name,
                    "yes" if row["second_order"] else "no",
                    f"{row['kd']:g}",
                    *(shown(row[key], ".2e") for key in ("first", "speed")),
                    *(shown(row[key], ".0f") for key in ("torque_rate", "jerk")),
                    shown(far["error"], ".4f"),
                    shown(far["speed"], ".1e"),
                    *(shown(far[key], ".0f") for key in ("torque_rate", "jerk")),
                ]
            )
    head = ["formulation", "second order", "kd [1/s]", "first task, worst phase [m, rad]"]
    head += ["mean abs(v), last 3 s, worst phase [rad/s]"]
    head += ["torque rate, phases 2 to 5 [Nm/s @ 1 ms]", "jerk integral, phase 2 [rad/s^2]"]
    head += ["out of reach: error [m]", "mean abs(v), last 3 s [rad/s]"]
    head += ["torque rate [Nm/s @ 1 ms]", "sum of abs(change of acceleration) [rad/s^2]"]
    return (
        "Five phases of `priority_switching` as in `phases`, and an end effector whose target is "
        "0.58 m out of reach from the start on (8 s, end_effector > elbow > posture), with "
        "`velocity_damping` kd, a quarter of it in force with `second_order`. That adds "
        "(x + kd v)^T S (x + kd v) to every level, kd the damping of its tasks.\n\n"
        + markdown_table(head, lines)
    )

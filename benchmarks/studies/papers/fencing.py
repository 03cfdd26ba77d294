"""Section III of Jeong and Chang (2009): a humanoid lunges at a target, near and out of reach."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import ghc_controller as ghc
from benchmarks.fencing_loop import Fencing, run_fencing
from benchmarks.study_results import shown
from ghc_controller.formulations import DampedLevels, Metric
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table as markdown_table

_DEFAULT = ghc.Settings().formulation

NAME = "fencing"
TITLE = "Fencing: a humanoid of 28 joints lunges at a target"
FORMULATIONS = (
    *("task_priority", "resolved_acceleration", "operational_space", "unifying"),
    *("cascade", "hqp", "ghc"),
)
FIGURE = "fencing.png"
CAPTION = (
    "Error of the sword's tip as in figures 2 and 4 of the paper, posture last: left the near "
    "target (22 cm on), right the far one (60 cm on). A cross is where a run stopped"
)
_QUICK = 0.02  # [s]
_PERIOD = 0.06  # [s] between two points of a stored curve
_SMALLEST = 1e-3  # [mm] drawn
_WIDTHS = (7.0, 5.5, 4.0, 2.5, 2.0, 1.0, 1.5)
_NOT_DRAWN = "(27), least torque"

_PAPER = ghc.FormulationSettings(velocity_damping=0.0)
_UNDAMPED = replace(_PAPER, damped_levels=DampedLevels.NONE)
_PRINTED = replace(_PAPER, damped_levels=DampedLevels.LOWER)
_LAWS: dict[str, dict[str, ghc.FormulationSettings]] = {
    "task_priority": {
        "(18)": _UNDAMPED,
        "(27)": _PRINTED,
        _NOT_DRAWN: replace(_PRINTED, metric=Metric.TORQUE),
    },
    "resolved_acceleration": {"pseudo-inverse": _UNDAMPED, "SR inverse": _PAPER},
    "operational_space": {"as printed": _UNDAMPED},
    "unifying": {"(40)": _UNDAMPED},
}
_DEFAULT_LAW = {"w = 0.01": _PAPER}


class _Mode(NamedTuple):
    """Cases of one table, and what it shows."""

    title: str
    cases: dict[str, Fencing]
    columns: dict[str, str]  # key of a figure -> head
    braked: bool = False  # accelerations are damped towards -kd v


_ERRORS = {
    "tip_max": "tip, largest [mm]",
    "tip_end": "tip, last quarter [mm]",
    "foot": "foot [mm]",
    "balance": "balance [mm]",
    "excess": "beyond joint limit [deg]",
    "jump": "torque step [Nm per 2 ms]",
}
_AS_PAPER = _ERRORS | {"torque": "torque, rms [Nm]", "stopped": "stopped at [s]"}
_BOUNDED = _ERRORS | {"qps": "ticks with a QP", "not_solved": "not SOLVED", "failed": "FAILED"}
_MODES = (
    _Mode(
        "As in the paper: joint limits are a level that switches, torques have no limits",
        {
            "near": Fencing("near"),
            "far": Fencing("far"),
            "near, no posture": Fencing("near", posture=False),
            "far, no posture": Fencing("far", posture=False),
        },
        _AS_PAPER,
    ),
    _Mode(
        "Joint and torque limits as bounds, velocity_damping 0 as above",
        {"near, bounds": Fencing("near_bounds"), "far, bounds": Fencing("far_bounds")},
        _BOUNDED,
    ),
    _Mode(
        "Joint and torque limits as bounds, velocity_damping 20 1/s (default)",
        {
            "near, bounds, damped": Fencing("near_bounds"),
            "far, bounds, damped": Fencing("far_bounds"),
        },
        _BOUNDED,
        braked=True,
    ),
)
_WITH_CURVE = ("near", "far")


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """One closed loop per law and case."""
    found: dict[str, dict[str, Any]] = {name: {} for name in formulations}
    for name in formulations:
        for law, settings in _LAWS.get(name, _DEFAULT_LAW).items():
            cases: dict[str, Any] = {}
            for mode in _MODES:
                used = replace(settings, velocity_damping=20.0) if mode.braked else settings
                for title, case in mode.cases.items():
                    case = case._replace(duration=_QUICK) if quick else case
                    with_curve = title in _WITH_CURVE and _is_drawn(name, law)
                    figures = run_fencing(name, used, case, with_curve)
                    kept = [*mode.columns, *(["curve"] if with_curve else [])]
                    cases[title] = {key: figures[key] for key in kept}
            found[name][law] = cases
    return {"facts": {"quick": quick}, "formulations": found}


def table(result: dict[str, Any]) -> str:
    """One table per mode, one line per case and law."""
    parts = [
        "Scenario `fencing` as a library loop (Controller and Simulator), 2 ms, 3 s, motion from "
        "0.5 to 1.7 s, w = lambda = 0.01. Errors of tip, foot and balance are the largest of a "
        "run; a run has stopped where the joints exceed 100 rad/s or the torques 20 kNm. Order: "
        "(joint limits >) balance > left foot > sword tip (> posture)."
    ]
    for mode in _MODES:
        lines = [
            [case, name, law, *(shown(cases[case][key], _form(key)) for key in mode.columns)]
            for case in mode.cases
            for name, laws in result["formulations"].items()
            for law, cases in laws.items()
        ]
        head = ["case", "formulation", "law", *mode.columns.values()]
        parts.append(f"{mode.title}:")
        parts.append(markdown_table(head, lines))
    return "\n\n".join(parts)


def _form(key: str) -> str:
    return "d" if key in ("qps", "not_solved", "failed") else ".3g"


def plot(result: dict[str, Any], path: Path) -> None:
    """Error of the tip over time, near and far."""
    figure = new_figure(8.6, 3.4)
    with styled():
        for place, case in zip(figure.subplots(1, 2), _WITH_CURVE, strict=True):
            for index, (label, figures) in enumerate(_drawn(result, case)):
                curve = [max(error, _SMALLEST) for error in figures["curve"]]
                times = [_PERIOD * k for k in range(len(curve))]
                width = _WIDTHS[index]  # laws that are one law lie on top of each other
                place.semilogy(times, curve, color=colour(index), lw=width, label=label)
                if figures["stopped"] is not None:
                    place.plot(times[-1], curve[-1], "x", color=colour(index))
            place.set_title(f"{case} target")
            place.set_xlabel("time [s]")
            place.set_ylabel("error of the tip [mm]")
        place.legend(loc="lower right", fontsize=6.5)
    save_png(figure, path)


def _drawn(result: dict[str, Any], case: str) -> list[tuple[str, dict[str, Any]]]:
    """Label and figures of the laws of the paper, and of the default formulation."""
    return [
        (f"{name}, {law}", cases[case])
        for name, laws in sorted(result["formulations"].items())
        for law, cases in sorted(laws.items())
        if _is_drawn(name, law)
    ]


def _is_drawn(name: str, law: str) -> bool:
    return name in (*_LAWS, _DEFAULT) and law != _NOT_DRAWN

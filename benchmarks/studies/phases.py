"""The five phases of `priority_switching`: errors, rest, torque rate, jerk, and the goals."""

from __future__ import annotations

from typing import Any, NamedTuple

import ghc_controller as ghc
from benchmarks.study_results import shown
from benchmarks.switching_loop import Timing, run_phases
from ghc_sim_bridge.programs.markdown import table as markdown_table

_DEFAULT = ghc.Settings().formulation

NAME = "phases"
TITLE = "KUKA, five phases of priority_switching"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")
GOALS = {"first": 3e-5, "speed": 1e-3, "torque_rate": 300.0, "jerk": 140.0}  # at most
RATIO_GOALS = {"torque_rate": 50.0, "jerk": 5.0}  # hqp at once over the default, at least
_SWITCH = 1  # index of the phase of the first switch
_QUICK = Timing(ramp=0.02, hold=0.03)


class Variant(NamedTuple):
    """Settings of one run beside the formulation."""

    title: str
    settings: ghc.FormulationSettings
    at_once: bool = False


_DEFAULTS = (Variant("defaults", ghc.FormulationSettings()),)
_PAPER = ghc.FormulationSettings(velocity_damping=0.0)
BASELINE = "at once, damped as in the literature"  # the hqp of the goals
_BRAKED = ghc.FormulationSettings(hqp_damps_velocity=True)
_VARIANTS = {
    "ghc": (*_DEFAULTS, Variant("as in the paper", _PAPER)),
    "hqp": (
        Variant(BASELINE, ghc.FormulationSettings(), at_once=True),
        Variant("at once, hqp_damps_velocity", _BRAKED, at_once=True),
    ),
}


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """One closed loop per formulation and variant."""
    timing = _QUICK if quick else Timing()
    found = {
        name: {
            variant.title: run_phases(
                name, variant.settings, timing._replace(ramp=0.0) if variant.at_once else timing
            )
            for variant in _VARIANTS.get(name, _DEFAULTS)
        }
        for name in formulations
    }
    return {"facts": {"quick": quick}, "formulations": found}


def table(result: dict[str, Any]) -> str:
    """All phases, then the goals of the default formulation and the ratios to `hqp`."""
    found = result["formulations"]
    lines = [
        line
        for name, variants in found.items()
        for title, run_result in variants.items()
        for line in _phase_lines(f"{name}, {title}", run_result)
    ]
    tasks = ["end_effector [m]", "elbow [m]", "posture [rad]"]
    head = ["formulation", "phase", "order", *tasks, "mean abs(v), last 3 s [rad/s]"]
    head += ["torque rate [Nm/s @ 1 ms]", "jerk integral [rad/s^2]"]
    text = (
        "Library loop (Controller and Simulator), 1 ms, torque rate limit off, velocity limit "
        "1.2 rad/s, transitions of 2 s (`hqp`: at once), phases held for 8 s, default settings; "
        "as in the paper: `velocity_damping` 0. Task errors are those at the end of a phase, "
        "jerk is integrated over a phase and added up over the joints.\n\n"
        + markdown_table(head, lines)
    )
    goals = _goals(found)
    if goals:
        head = ["goal", "at", "measured", ""]
        text += "\n\nGoals:\n\n" + markdown_table(head, goals)
    return text


def _phase_lines(title: str, run_result: dict[str, Any]) -> list[list[str]]:
    lines = []
    for number, phase in enumerate(run_result["phases"], 1):
        errors = [shown(phase["errors"][key], ".1e") for key in _TASKS]
        figures = [shown(phase[key], form) for key, form in _FORMS.items()]
        lines.append([title, str(number), phase["hierarchy"], *errors, *figures])
    if run_result["diverged_at_s"] is not None:
        lines.append([title, f"diverged at {run_result['diverged_at_s']:g} s", *["-"] * 7])
    return lines


_TASKS = ("end_effector", "elbow", "posture")
_FORMS = {"speed": ".1e", "torque_rate": ".0f", "jerk": ".0f"}


def _goals(found: dict[str, Any]) -> list[list[str]]:
    """Goals whose figures are there."""
    phases = [
        variants["defaults"]["phases"] for name, variants in found.items() if name == _DEFAULT
    ]
    if not phases or len(phases[0]) <= _SWITCH:
        return []
    mine = phases[0]
    lines = []
    for what, key, part in (
        ("first task of each order, end of a phase [m, rad]", "first", mine),
        ("mean abs(v), last 3 s of a phase [rad/s]", "speed", mine),
        ("torque rate, phases 2 to 5 [Nm/s @ 1 ms]", "torque_rate", mine[1:]),
        ("jerk integral, phase 2 [rad/s^2]", "jerk", mine[_SWITCH : _SWITCH + 1]),
    ):
        worst = max(phase[key] for phase in part)
        mark = "met" if worst <= GOALS[key] else "missed"
        lines.append(
            [
                f"{_DEFAULT}: {what}",
                f"at most {GOALS[key]:g}",
                f"{worst:.3g}",
                mark,
            ]
        )
    for title, other in found.get("hqp", {}).items():
        if len(other["phases"]) <= _SWITCH:
            continue
        for key, what in (("torque_rate", "torque rate"), ("jerk", "jerk integral")):
            ratio = other["phases"][_SWITCH][key] / mine[_SWITCH][key]
            goal, mark = "-", ""  # for comparison
            if title == BASELINE:
                goal = f"at least {RATIO_GOALS[key]:g} times"
                mark = "met" if ratio >= RATIO_GOALS[key] else "missed"
            lines.append(
                [
                    f"hqp, {title}: {what} of phase 2, over {_DEFAULT}",
                    goal,
                    f"{ratio:.3g}",
                    mark,
                ]
            )
    return lines

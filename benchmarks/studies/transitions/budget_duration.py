"""One swap of the KUKA under torque-rate budgets: duration against budget, and two torques."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import ghc_controller as ghc
from benchmarks.ramps.budget_ramps import PERIOD, Case, begin_case, follow, whole_change
from benchmarks.study_results import shown
from benchmarks.switching_loop import target_references
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.figures.style import colour, new_figure, save_png, styled
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "budget_duration"
TITLE = "KUKA, duration of a transition against its torque-rate budget"
FORMULATIONS = ("cascade",)
FIGURE = "budget_duration.png"
CAPTION = (
    "Left: duration of a swap against its budget, standing still and moving; lines: whole change "
    "of torque over budget. Right: torque of the joint that changes most, standing still, under "
    "two budgets; dotted: end of the transition"
)
_BEGIN, _GOAL = "end_effector > elbow > posture", "elbow > end_effector > posture"
_WAYS = ("standing still", "moving")
_LEAD = 0.5  # [s] of motion before the swap
_BUDGETS = tuple(float(f"{b:.3g}") for b in np.geomspace(10.0, 1000.0, 13))  # [Nm/s]
_CURVES = (30.0, 100.0)  # [Nm/s] whose torques are drawn
_POINTS = 120  # of a curve
_MARGIN = 0.1  # [s] of a curve before and after its ramp


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Durations for all budgets, and torques over time for two."""
    budgets, curves = ((100.0, 1000.0), (1000.0,)) if quick else (_BUDGETS, _CURVES)
    found: dict[str, Any] = {}
    for name in formulations:
        settings = ghc.Settings(formulation=name, torque_rate_limit=0.0, velocity_limit=1.2)
        controller = ghc.Controller.for_robot("kuka_lwr", settings)
        still = _case(controller)
        moving = replace(still, scene="kuka_lwr", lead=0.01 if quick else _LEAD)
        rows = {}
        for title, case in zip(_WAYS, (still, moving), strict=True):
            ways = [follow(controller, case, 0.0, budget) for budget in budgets]
            rows[title] = {
                "change_nm": whole_change(controller, case),
                "duration_s": [way.duration for way in ways],
                "added_over_budget": max(
                    way.added / budget for way, budget in zip(ways, budgets, strict=True)
                ),
            }
        found[name] = {
            "ways": rows,
            "curves": {f"{budget:g}": _curve(controller, still, budget) for budget in curves},
        }
    facts = {"budgets_nm_per_s": budgets, "begin": _BEGIN, "goal": _GOAL, "lead_s": _LEAD}
    return {"facts": facts, "formulations": found}


def _case(controller: ghc.Controller) -> Case:
    names = controller.robot.task_names
    q = Simulator("kuka_lwr", joint_names=controller.model.joint_names).start
    controller.observe(ghc.RobotState(0.0, q, np.zeros(controller.model.nv)))
    references = list(target_references(controller))
    begin, goal = ([names.index(name) for name in text.split(" > ")] for text in (_BEGIN, _GOAL))
    return Case(q, references, begin, goal, "", PERIOD)


def _curve(controller: ghc.Controller, case: Case, budget: float) -> dict[str, Any]:
    """Torque of the joint that changes most, from a little before to a little after the ramp."""
    duration = follow(controller, case, 0.0, budget).duration
    step = begin_case(controller, case)
    target = ghc.matrix_from_hierarchy(controller.robot.task_names, _GOAL)
    transition = ghc.Transition(target, _MARGIN, 0.0, ghc.Profile.LINEAR, torque_rate=budget)
    controller.add_transition(transition, 0.0)
    ticks = round((2.0 * _MARGIN + duration) / PERIOD)
    path = np.array([step(tick * PERIOD).copy() for tick in range(ticks)])
    joint = int(np.ptp(path, axis=0).argmax())
    chosen = np.unique(np.linspace(0, ticks - 1, _POINTS).round().astype(int))
    return {
        "joint": controller.model.joint_names[joint],
        "duration_s": duration,
        "time_s": [index * PERIOD - _MARGIN for index in chosen],
        "torque_nm": [path[index, joint] for index in chosen],
    }


def table(result: dict[str, Any]) -> str:
    """One line per formulation and budget."""
    facts = result["facts"]
    lines = []
    for name, found in result["formulations"].items():
        ways = found["ways"]
        for index, budget in enumerate(facts["budgets_nm_per_s"]):
            times = [shown(ways[title]["duration_s"][index]) for title in _WAYS]
            ideal = [f"{ways[title]['change_nm'] / budget:.3g}" for title in _WAYS]
            lines.append([name, f"{budget:g}", *times, *ideal])
    head = ["formulation", "budget [Nm/s]", "standing still [s]", "moving [s]"]
    head += ["change / budget, standing still [s]", "moving [s]"]
    most = max(
        row["added_over_budget"]
        for found in result["formulations"].values()
        for row in found["ways"].values()
    )
    return (
        f"Swap of {facts['begin']} to {facts['goal']}, targets of `priority_switching`, from its "
        f"start posture; moving: in closed loop, {facts['lead_s']:g} s after the start. Change: "
        "largest difference of a joint's torque between both orders where the ramp begins. What "
        f"a ramp adds to the torque rate is at most {most:.3g} of the budget.\n\n"
        + markdown_table(head, lines)
    )


def plot(result: dict[str, Any], path: Path) -> None:
    """Duration against budget, and torque over time."""
    figure = new_figure(8.6, 3.4)
    found = result["formulations"][FORMULATIONS[0]]
    with styled():
        left, right = figure.subplots(1, 2)
        _draw_durations(left, result["facts"]["budgets_nm_per_s"], found["ways"])
        _draw_torques(right, found["curves"])
    save_png(figure, path)


def _draw_torques(ax: Axes, curves: dict[str, Any]) -> None:
    for index, budget in enumerate(sorted(curves, key=float)):
        curve = curves[budget]
        ax.plot(curve["time_s"], curve["torque_nm"], color=colour(index), label=f"{budget} Nm/s")
        ax.axvline(curve["duration_s"], color=colour(index), lw=0.8, ls=":")
        ax.set_ylabel(f"torque of {curve['joint']} [Nm]")
    ax.set_xlabel("time since the start of the transition [s]")
    ax.legend(loc="lower right")


def _draw_durations(ax: Axes, budgets: list[float], ways: dict[str, Any]) -> None:
    for index, title in enumerate(_WAYS):
        row = ways[title]
        ax.plot(
            budgets,
            [np.nan if time is None else time for time in row["duration_s"]],
            color=colour(index),
            marker="o",
            markersize=3.5,
            ls="",
            label=title,
        )
        ideal = [row["change_nm"] / budget for budget in budgets]
        label = f"change / budget, {row['change_nm']:.3g} Nm"
        ax.plot(budgets, ideal, color=colour(index), lw=0.9, label=label)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("torque_rate [Nm/s]")
    ax.set_ylabel("duration [s]")
    ax.legend(loc="lower left")

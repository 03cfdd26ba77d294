"""The measured figures against the goals of the project, and the ratios between formulations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ghc_controller as ghc

_DEFAULT = ghc.Settings().formulation

Row = dict[str, Any]

_TASKS = 5
_STEP_GOALS = {"kuka_lwr": 100.0, "icub": 250.0}  # [us] median, at most
_RATIO_GOALS = {"kuka_lwr": 2.0, "icub": 5.0}  # ghc_full over ghc, at least
_REAL_TIME_GOALS = {False: 1.2, True: 1.0}  # [-] without and with generators, at least
_STANDING_GOAL = 1000.0  # [us] median, at most
_CHECKED = (_DEFAULT, "ghc", "balanced")
_OVER_BALANCED = 1.5  # [-] median of the default over that of balanced, no bound active, at most
_STANDING_CHECKED = (_DEFAULT, "balanced")
TICK_GOAL = 2000.0  # [us] median tick of a generator, at most
TICK_COUNT, TICK_HORIZON = 4, 1.5  # with so many contacts or obstacles, N T [s]


def ratios(step: Sequence[Row]) -> list[Row]:
    """Median of ghc_full over that of ghc, for each case and each solver that both ran with."""
    found = []
    for row in step:
        if row["formulation"] != "ghc":
            continue
        full = _find(step, row["robot"], row["tasks"], row["regime"], "ghc_full", row["solver"])
        if full is not None:
            case = {key: row[key] for key in ("robot", "tasks", "regime", "solver")}
            ratio = full["median_us"] / row["median_us"]
            found.append({**case, "full_over_condensed": round(ratio, 2)})
    return found


def check_goals(
    step: Sequence[Row],
    loop: Sequence[Row],
    mpc: Sequence[Row] = (),
    standing: Sequence[Row] = (),
) -> list[Row]:
    """Each goal with what was measured, and whether it is met."""
    checked = []
    for robot, limit in _STEP_GOALS.items():
        for formulation in _CHECKED:
            for regime in ("inactive", "active"):
                row = _find(step, robot, _TASKS, regime, formulation, "daqp")
                if row is not None:
                    what = f"{robot}, {_TASKS} tasks, {formulation}: median step [us]"
                    checked.append(_goal(what, regime, "<=", limit, row["median_us"]))
        default, balanced = (
            _find(step, robot, _TASKS, "inactive", formulation, "daqp")
            for formulation in (_DEFAULT, "balanced")
        )
        if default is not None and balanced is not None:
            what = f"{robot}, {_TASKS} tasks: {_DEFAULT} over balanced"
            ratio = round(default["median_us"] / balanced["median_us"], 2)
            checked.append(_goal(what, "inactive", "<=", _OVER_BALANCED, ratio))
    for row in ratios(step):
        if row["tasks"] == _TASKS and row["solver"] == "daqp":
            what = f"{row['robot']}, {_TASKS} tasks: ghc_full over ghc"
            least = _RATIO_GOALS[row["robot"]]
            checked.append(_goal(what, row["regime"], ">=", least, row["full_over_condensed"]))
    for row in standing:
        if row["tasks"] == _TASKS and row["formulation"] in _STANDING_CHECKED:
            what = (
                f"iCub standing on both feet, {_TASKS} tasks, {row['formulation']}: "
                "median step [us]"
            )
            checked.append(_goal(what, "", "<=", _STANDING_GOAL, row["median_us"]))
    for row in loop:
        if row["executor"] == "events":
            with_them = " with both generators" if row["generators"] else ""
            what = f"lockstep over DDS at 1 kHz{with_them}: real time factor"
            least = _REAL_TIME_GOALS[row["generators"]]
            checked.append(_goal(f"{what}, all runs", "", ">=", least, row["real_time_factor"]))
            calmest = row["calmest_real_time_factor"]
            checked.append(_goal(f"{what}, calmest run", "", ">=", least, calmest))
    for row in mpc:
        if (row["count"], row["horizon"]) == (TICK_COUNT, TICK_HORIZON):
            handled = f"{row['count']} {row['handles']}, N T = {row['horizon']:g} s"
            for kind, title in (("warm", "tick"), ("changed", "tick with new inputs")):
                what = f"{row['generator']}, {handled}: median {title} [us]"
                median = row["ticks_us"][kind]["median"]
                checked.append(_goal(what, "", "<=", TICK_GOAL, median))
    return checked


def _find(
    step: Sequence[Row], robot: str, tasks: int, regime: str, formulation: str, solver: str
) -> Row | None:
    wanted = (robot, tasks, regime, formulation, solver)
    keys = ("robot", "tasks", "regime", "formulation", "solver")
    return next((row for row in step if tuple(row[key] for key in keys) == wanted), None)


def _goal(what: str, regime: str, relation: str, goal: float, measured: float) -> Row:
    met = measured <= goal if relation == "<=" else measured >= goal
    return {
        "goal": what,
        "regime": regime,
        "relation": relation,
        "limit": goal,
        "measured": measured,
        "met": met,
    }

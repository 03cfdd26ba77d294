"""The measured figures against the goals of the project, and the ratios between formulations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Row = dict[str, Any]

_TASKS = 5
_STEP_GOALS = {"kuka_lwr": 100.0, "icub": 250.0}  # [us] median, at most
_RATIO_GOALS = {"kuka_lwr": 2.0, "icub": 5.0}  # ghc_full over ghc, at least
_REAL_TIME_GOAL = 1.2  # [-] lockstep over DDS at 1 kHz, at least
_CHECKED = ("ghc", "balanced")


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


def check_goals(step: Sequence[Row], loop: Sequence[Row]) -> list[Row]:
    """Each goal with what was measured, and whether it is met."""
    checked = []
    for robot, limit in _STEP_GOALS.items():
        for formulation in _CHECKED:
            for regime in ("inactive", "active"):
                row = _find(step, robot, _TASKS, regime, formulation, "daqp")
                if row is not None:
                    what = f"{robot}, {_TASKS} tasks, {formulation}: median step [us]"
                    checked.append(_goal(what, regime, "<=", limit, row["median_us"]))
    for row in ratios(step):
        if row["tasks"] == _TASKS and row["solver"] == "daqp":
            what = f"{row['robot']}, {_TASKS} tasks: ghc_full over ghc"
            least = _RATIO_GOALS[row["robot"]]
            checked.append(_goal(what, row["regime"], ">=", least, row["full_over_condensed"]))
    for row in loop:
        if row["executor"] == "events":
            what = "lockstep over DDS at 1 kHz: real time factor"
            checked.append(_goal(what, "", ">=", _REAL_TIME_GOAL, row["real_time_factor"]))
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

"""Tables of the papers next to results of the comparison."""

from __future__ import annotations

from typing import Any

from benchmarks.compare.store import Results
from benchmarks.law_operations import COUNTS
from benchmarks.rhp_page import PAPER_1, PAPER_2, PAPER_3
from ghc_sim_bridge.programs.markdown import number, table
from ghc_sim_bridge.scenario.scenario import load_scenario

_ROWS = (3, 2, 3, 3)  # of the levels whose cost the paper of 2009 states, 28 joints
_TIMES = {  # [ms] section III.B.3 of Jeong and Chang (2009)
    "task_priority": 1.4,
    "resolved_acceleration": 2.7,
    "unifying": 3.2,
    "operational_space": 4.8,
}
_LUNGE = {  # figures 2 and 4 of the same, in its words
    "task_priority_undamped": ("accurate", "-"),
    "task_priority": ("-", "as near as balance and limits allow"),
    "resolved_acceleration_undamped": ("accurate", "unstable"),
    "resolved_acceleration": ("-", "good"),
    "operational_space_undamped": ("accurate", "shown, not discussed"),
    "unifying_undamped": ("misses", "wrong position"),
}
_GHC = ("cascade", "ghc", "hqp")


def ghc_table(results: Results) -> str:
    """Table 1 of the GHC paper: errors at the end of each phase."""
    ours = results.get("priority_switching", {})
    lines = []
    for number_, phase in enumerate(load_scenario("priority_switching").phases):
        for task, unit in (("end_effector", "m"), ("elbow", "m"), ("posture", "rad")):
            paper = phase.paper or {}
            theirs = [_shown(paper.get(name, {}).get(task)) for name in ("ghc", "hqp")]
            cells = [_end(ours.get(name), number_, task) for name in _GHC]
            lines.append([f"{phase.hierarchy}: {task} [{unit}]", *theirs, *cells])
    head = ["order and task", "paper, GHC", "paper, HQP", *(f"ours, {name}" for name in _GHC)]
    return table(head, lines)


def _end(result: Any, phase: int, task: str) -> str:
    if result is None or "rejected" in result or phase >= len(result["phases"]):
        return "–"
    found = [t["end"] for t in result["phases"][phase]["tasks"] if t["task"] == task]
    return number(found[0], 3) if found else "–"


def _shown(value: float | None) -> str:
    return number(value)


def _task(results: Results, case: str, method: str, task: str, key: str) -> float | None:
    result = results.get(case, {}).get(method, {})
    for each in result.get("phases", [{}])[0].get("tasks", []):
        if each["task"] == task:
            return float(each[key])
    return None


def rhp_table(results: Results) -> str:
    """Tables I and II of RHP-HQP: largest error of the hand, and its integral."""
    lines = []
    for name in ("rhp_hqp", "hqp_transition", "hqp", "cascade", "ghc", "balanced"):
        for w in ("0.0001", "0.01"):
            cells = []
            for case in ("constant", "distance", "ramp"):
                found = _task(results, f"upper_body_{case}_w{w}", name, "hand", "max")
                cells.append(number(None if found is None else 1e3 * found, 3))
            for case in ("distance", "ramp"):
                mean = _task(results, f"upper_body_{case}_w{w}", name, "hand", "mean")
                cells.append(number(None if mean is None else 7.0 * mean, 3))  # runs of 7 s
            largest, integral = PAPER_2.get(name, ("–", "–"))
            lines.append([name, w, PAPER_1.get(name, "–"), cells[0], largest, integral])
            lines[-1] += [cells[1], cells[3], cells[2], cells[4]]
    head = ["formulation", "w", "case 1: paper, largest [mm]", "ours [mm]"]
    head += ["case 2: paper, largest [m]", "paper, integral"]
    head += ["ours by distance, largest [mm]", "integral [m s]"]
    return table([*head, "timed ramp, largest [mm]", "integral [m s]"], lines)


def rhp_cost_table(results: Results) -> str:
    """Table III of RHP-HQP: what a transition costs."""
    lines = []
    for name, (without, during) in PAPER_3.items():
        result = results.get("upper_body_distance_w0.0001", {}).get(name, {})
        paper = [number(without), number(during), number(during / without)]
        counts = [result.get("qps"), result.get("qps_changing"), result.get("operations")]
        scaled = [*counts[:2], None if counts[2] is None else counts[2] / 1e3]
        lines.append([name, *paper, *map(number, scaled)])
    head = ["formulation", "paper, one order [ms]", "mixed [ms]", "ratio"]
    return table([*head, "ours, QPs per step", "while orders change", "operations [k]"], lines)


def lunge_table(results: Results) -> str:
    """Figures 2 and 4 of Jeong and Chang: error of the sword's tip over the last quarter."""
    lines = []
    for name, words in (*_LUNGE.items(), ("cascade", ("", "")), ("hqp", ("", ""))):
        cells = []
        for case, word in zip(("fencing_near", "fencing_far"), words, strict=True):
            stopped = results.get(case, {}).get(name, {}).get("stopped_s")
            tip = _task(results, case, name, "sword_tip", "end")
            ours = number(None if tip is None else 1e3 * tip, 3)
            cells += [word or "–", f"stops after {stopped:.2f} s" if stopped else ours]
        lines.append([name, *cells])
    head = ["law", "paper, near", "ours, near [mm]", "paper, far", "ours, far [mm]"]
    return table(head, lines)


def cost_table() -> str:
    """Section III.B.3 of the same: time of a step, beside the operations that we count."""
    counts = {name: COUNTS[name](28, _ROWS) for name in _TIMES}
    least = counts["task_priority"]
    lines = [
        [name, f"{time:g}", number(time / 1.4, 3), number(counts[name] / least, 3)]
        + [number(counts[name] / 1e3, 3)]
        for name, time in _TIMES.items()
    ]
    return table(["law", "paper [ms]", "ratio", "operations, ratio", "operations [k]"], lines)

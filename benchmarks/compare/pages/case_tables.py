"""The tables of one case: errors by level, and other measures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmarks.compare.case import Case
from ghc_sim_bridge.programs.markdown import number, table

_COLUMNS = {  # key -> head
    "strict_first": "loss of level 1 at a bound",
    "strict_any": "of any level at a bound",
    "strict_free": "of any level, no bound",
    "ramp_step": "step of a ramp [%]",
    "torque_rate": "torque rate [Nm/s @ {period:g} ms]",
    "torque_rate_changing": "the same while orders change",
    "jerk": "jerk [rad/s²]",
    "swing": "swing [rad/s]",
    "qps": "QPs per step",
    "qps_changing": "while orders change",
    "pivots": "pivots",
    "operations": "operations [k]",
    "unsolved": "steps not SOLVED",
}
_SCALES = {"ramp_step": 100.0, "operations": 1e-3}


def case_tables(case: Case, by_method: Mapping[str, Any]) -> str:
    """Both tables of a case, and the reasons of those that reject it."""
    ran = {name: result for name, result in by_method.items() if "rejected" not in result}
    parts = [_errors(case, ran), _behavior(ran)] if ran else []
    reasons: dict[str, list[str]] = {}
    for name, result in by_method.items():
        if "rejected" in result:
            reason = result["rejected"].replace(f"'{name}'", "")
            reasons.setdefault(" ".join(reason.split()), []).append(f"`{name}`")
    parts += [f"Rejected by {', '.join(names)}: {reason}." for reason, names in reasons.items()]
    return "\n\n".join(parts)


def _errors(case: Case, ran: Mapping[str, Any]) -> str:
    """Largest error of each level over its tasks and the phases that were reached."""
    figure = "end" if case.figure == "none" else case.figure
    labels: dict[int, list[str]] = {}
    for phase in next(iter(ran.values()))["phases"]:
        for task in phase["tasks"]:
            names = labels.setdefault(task["level"], [])
            names += [task["task"]] if task["task"] not in names else []
    lines = []
    for name, result in ran.items():
        cells = []
        for level in labels:
            tasks = [
                t for phase in result["phases"] for t in phase["tasks"] if t["level"] == level
            ]
            cells.append(number(max((t[figure] for t in tasks), default=None), 3))
        stopped = result.get("stopped_s")
        lines.append([name, *cells, "–" if stopped is None else f"{stopped:.2f}"])
    heads = [f"level {level}: {_title(names)}" for level, names in labels.items()]
    return table(["error", *heads, "stopped at [s]"], lines)


def _title(names: list[str]) -> str:
    return ", ".join(names) if len(names) < 4 else "several tasks"


def _behavior(ran: Mapping[str, Any]) -> str:
    first = next(iter(ran.values()))
    kept = [key for key in _COLUMNS if any(r.get(key) is not None for r in ran.values())]
    heads = [_COLUMNS[key].format(period=1e3 * first.get("period_s", 0.0)) for key in kept]
    lines = [
        [name, *(_cell(result.get(key), _SCALES.get(key, 1.0)) for key in kept)]
        for name, result in ran.items()
    ]
    return table(["formulation", *heads], lines)


def _cell(value: float | None, scale: float) -> str:
    if value is None or isinstance(value, int):
        return "–" if value is None else str(value)
    return number(value * scale)

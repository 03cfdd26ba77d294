"""Sections on constraints that jump: the thesis' chapters 4 and 5 on the arm."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ghc_sim_bridge.programs.markdown import number, picture, table
from ghc_sim_bridge.programs.paper.runs import PAPERS_OWN, beside

Summaries = Mapping[str, Mapping[str, Any]]
Pictures = frozenset[str]


def force_section(summaries: Summaries, pictures: Pictures) -> str:
    """Thesis, figures 5.12 and 5.13."""
    return _section(
        "## Thesis, figures 5.12 and 5.13: a force bound that steps (`force_bound_step`)",
        _comparisons(summaries, "force_bound_step"),
        _force_line,
        pictures,
        "force_bound_step",
        "Figures 5.12 and 5.13: normal force with its bounds, joint torques, largest torque rate.",
        _FORCE_REASONS,
    )


_FORCE_REASONS = """As in the thesis: with raw bounds the torques jump wherever the bound does,
with smoothed ones they begin to move before the event and are there when it comes. A schedule is
known beforehand, so the bound is never looser than the raw one. The thesis prints no values of its
bounds or forces; ours stand in the scenario file. The largest difference between asked and
simulated force is the answer of the soft contact to a jump: it is gone where nothing jumps."""


def obstacle_section(summaries: Summaries, pictures: Pictures) -> str:
    """Thesis, figure 4.10, on the arm."""
    return _section(
        "## Thesis, figure 4.10: an obstacle that jumps (`obstacle_jump`)",
        _comparisons(summaries, "obstacle_jump"),
        _obstacle_line,
        pictures,
        "obstacle_jump",
        "Figure 4.10 on the arm: distance to the obstacle, end effector, joint torques, largest "
        "torque rate.",
        _OBSTACLE_REASONS,
    )


_OBSTACLE_REASONS = """Why it differs from the thesis: there the left hand of a humanoid gives way
while the other hand is on a table; here the arm does. As there, the raw constraint moves the end
effector at once and the smoothed one within the reaction time of eq. 4.4: the price of smooth
torques is the time inside the safe distance, which that distance has to allow for. The overshoot
study is in [mpc_studies.md](mpc_studies.md)."""

_SIDES = {"off": "raw bounds", "on": "smoothed bounds"}
_KINDS = {"contacts": "contact", "obstacles": "obstacle"}


def _force_line(values: Mapping[str, Any]) -> str:
    return (
        "the QP's force was beyond its bounds by "
        f"at most {number(values['qp_violation'])} N; the simulated force differed "
        f"from it by {number(values['difference_rms'])} N (root mean square), at most "
        f"{number(values['difference_largest'])} N, and was above the bound in force "
        f"by at most {number(values['above_upper'])} N."
    )


def _obstacle_line(values: Mapping[str, Any]) -> str:
    return (
        "the distance predicted by eq. 4.2 was "
        f"missed by at most {number(values['qp_violation_m'])} m; the end effector "
        "was inside the safe distance of the obstacle itself for "
        f"{number(values['inside_safe_distance_s'])} s."
    )


def _comparisons(summaries: Summaries, scenario: str) -> dict[str, Mapping[str, Any]]:
    """Raw against smoothed bounds by formulation: the default first, then the paper's."""
    found = [summaries.get(name, {}).get("comparison") for name in (scenario, beside(scenario))]
    return {data["formulation"]: data for data in found if data is not None}


def _section(
    title: str,
    comparisons: Mapping[str, Mapping[str, Any]],
    line: Callable[[Mapping[str, Any]], str],
    pictures: Pictures,
    name: str,
    caption: str,
    reasons: str,
) -> str:
    """Table of events, bound violations, and figures; "" without a comparison."""
    if not comparisons:
        return ""
    files = ((name, caption), (beside(name), f"The same with `{PAPERS_OWN}`."))
    parts = [
        title,
        "Largest torque rate of any joint around each event (asked: at least 10 times lower with\n"
        "smoothed bounds):",
        _events(comparisons),
        "\n".join(
            f"- `{formulation}`, {_KINDS[kind]} `{item}`, {_SIDES[side]}: {line(values)}"
            for formulation, data in comparisons.items()
            for kind in _KINDS
            for item, sides in data[kind].items()
            for side, values in sides.items()
            if values is not None
        ),
        *(picture(f"{file}.png", text) for file, text in files if f"{file}.png" in pictures),
        reasons,
    ]
    return "\n\n".join(part for part in parts if part)


def _events(comparisons: Mapping[str, Mapping[str, Any]]) -> str:
    first = next(iter(comparisons.values()))
    period = 1e3 * first["control_dt_s"]
    head = ["event", "at [s]"]
    for name in comparisons:
        head += [f"`{name}`, raw bounds [Nm/s at {period:g} ms]", "smoothed", "ratio"]
    rows = []
    for k, event in enumerate(first["events"]):
        row = [event["name"], f"{event['time_s']:g}"]
        for data in comparisons.values():
            rates = data["events"][k]["peak_torque_rate_nm_per_s"]
            row += [f"{rates['off']:.0f}", f"{rates['on']:.0f}"]
            row.append(number(data["events"][k]["ratio"], 3))
        rows.append(row)
    return table(head, rows)

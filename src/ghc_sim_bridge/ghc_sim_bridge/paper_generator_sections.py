"""Sections on constraints that jump: the thesis' chapters 4 and 5 on the arm."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ghc_sim_bridge.markdown import number, picture, table

Summaries = Mapping[str, Mapping[str, Any]]
Pictures = frozenset[str]


def force_section(summaries: Summaries, pictures: Pictures) -> str:
    """Thesis, figures 5.12 and 5.13."""
    data = _comparison(summaries, "force_bound_step")
    if data is None:
        return ""
    lines = []
    for name, sides in data["contacts"].items():
        for side, values in sides.items():
            if values is not None:
                lines.append(
                    f"- contact `{name}`, {_SIDES[side]}: the QP's force was beyond its bounds by "
                    f"at most {number(values['qp_violation'])} N; the simulated force differed "
                    f"from it by {number(values['difference_rms'])} N (root mean square), at most "
                    f"{number(values['difference_largest'])} N, and was above the bound in force "
                    f"by at most {number(values['above_upper'])} N."
                )
    return _section(
        "## Thesis, figures 5.12 and 5.13: a force bound that steps (`force_bound_step`)",
        data,
        lines,
        pictures,
        "force_bound_step.png",
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
    data = _comparison(summaries, "obstacle_jump")
    if data is None:
        return ""
    lines = []
    for name, sides in data["obstacles"].items():
        for side, values in sides.items():
            if values is not None:
                lines.append(
                    f"- obstacle `{name}`, {_SIDES[side]}: the distance predicted by eq. 4.2 was "
                    f"missed by at most {number(values['qp_violation_m'])} m; the end effector "
                    "was inside the safe distance of the obstacle itself for "
                    f"{number(values['inside_safe_distance_s'])} s."
                )
    return _section(
        "## Thesis, figure 4.10: an obstacle that jumps (`obstacle_jump`)",
        data,
        lines,
        pictures,
        "obstacle_jump.png",
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


def _comparison(summaries: Summaries, name: str) -> Mapping[str, Any] | None:
    found: Mapping[str, Any] | None = summaries.get(name, {}).get("comparison")
    return found


def _section(
    title: str,
    data: Mapping[str, Any],
    lines: list[str],
    pictures: Pictures,
    file: str,
    caption: str,
    reasons: str,
) -> str:
    period = 1e3 * data["control_dt_s"]
    head = ["event", "at [s]", f"raw bounds [Nm/s at {period:g} ms]", "smoothed", "ratio"]
    rows = [
        [
            event["name"],
            f"{event['time_s']:g}",
            *(f"{event['peak_torque_rate_nm_per_s'][side]:.0f}" for side in ("off", "on")),
            number(event["ratio"], 3),
        ]
        for event in data["events"]
    ]
    parts = [
        title,
        "Largest torque rate of any joint around each event (asked: at least 10 times lower with\n"
        "smoothed bounds):",
        table(head, rows),
        "\n".join(lines),
        picture(file, caption) if file in pictures else "",
        reasons,
    ]
    return "\n\n".join(part for part in parts if part)

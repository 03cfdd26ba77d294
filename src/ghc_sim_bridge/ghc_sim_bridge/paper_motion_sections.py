"""Sections on insertion, tracking, contact force and non-strict priorities."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ghc_sim_bridge.markdown import number, picture, table
from ghc_sim_bridge.paper_pictures import NONSTRICT_RUNS

Summary = Mapping[str, Any]
Summaries = Mapping[str, Summary]
Pictures = frozenset[str]


def insertion_section(summaries: Summaries, pictures: Pictures) -> str:
    """Thesis, section 3.3.1."""
    summary = summaries.get("insertion_removal")
    if summary is None:
        return ""
    return "\n\n".join(
        [
            "## Thesis, figure 3.2: insertion and removal of a task (`insertion_removal`)",
            _phases(summary),
            *_shown(
                pictures,
                [
                    (
                        "insertion_removal_tasks.png",
                        "Thesis, figure 3.2: the end-effector task is inserted at the top and "
                        "removed again.",
                    )
                ],
            ),
            _INSERTION_REASONS,
        ]
    )


_INSERTION_REASONS = """As in the thesis: the end-effector error falls to zero while its task is on
top, the elbow keeps what is left of its own, and no error jumps. The sizes follow our targets."""


def lemniscate_section(summaries: Summaries, pictures: Pictures) -> str:
    """Figures 6 to 8."""
    summary = summaries.get("lemniscate")
    if summary is None:
        return ""
    paper, excess = summary["paper"], summary["limit_violations"]
    return "\n\n".join(
        [
            "## Figures 6 to 8: tracking within velocity and torque bounds (`lemniscate`)",
            _phases(summary),
            f"Bounds: velocity {paper['velocity_limit_rad_per_s']:g} rad/s and torque "
            f"{paper['torque_limit_nm']:g} Nm, as in the paper. Largest excess: velocity "
            f"{number(100.0 * excess['velocity'])} %, torque "
            f"{number(100.0 * excess['torque_bound'])} %. Ticks with a soft row giving way: "
            f"{summary['counts'].get('relaxed_ticks', '–')}.",
            *_shown(
                pictures,
                [
                    (
                        "lemniscate_path.png",
                        "Figure 6: desired and resulting path of the end effector.",
                    ),
                    ("lemniscate_tasks.png", "Figure 7: priorities and task errors."),
                    (
                        "lemniscate_joints.png",
                        "Figure 8: joint velocities and torques with their bounds.",
                    ),
                ],
            ),
            _LEMNISCATE_REASONS,
        ]
    )


_LEMNISCATE_REASONS = """Why they differ from the paper's: 1.5 Nm on the torques themselves, which
is what the paper prints, cannot hold this arm up: its shoulder needs some ten times that against
gravity. We take the reading under which the experiment is possible and the figure means the same:
the bound holds for what is commanded beyond gravity, |tau - g(q)| <= 1.5 Nm, in every joint. The
curve has the size and the period (2 pi s) of the paper's; its centre is moved, since at the
paper's (0.40, 0, 0.40) m this arm folds onto the end stop of joint 4."""


def contact_section(summaries: Summaries, pictures: Pictures) -> str:
    """Figures 9 and 10."""
    summary = summaries.get("contact_force")
    if summary is None:
        return ""
    task, ends = next(iter(summary["contact_force"].items()))
    end = ends[-1]
    desired, measured = end["desired_n"], end["measured_n"]
    forces = ", ".join(
        f"{axis}: desired {number(d, 3)} N, resulting {number(m, 4)} N"
        for axis, d, m in zip("xyz", desired, measured, strict=True)
        if d != 0.0
    )
    return "\n\n".join(
        [
            "## Figures 9 and 10: contact force (`contact_force`)",
            _phases(summary),
            f"Force of `{task}` on the plane at the end: {forces}.",
            *_shown(
                pictures,
                [
                    (
                        "contact_force.png",
                        "Figure 10: position errors, desired and resulting contact force.",
                    )
                ],
            ),
            _CONTACT_REASONS,
        ]
    )


_CONTACT_REASONS = """As in the paper: after the switch the end effector moves to the plane and,
once it touches, holds the desired normal force and its place within the plane (eq. 3). Why they
differ: the paper shows a peak of the force at the impact. Its size follows the softness of the
contact and the speed of the approach, which the paper does not state; here the plane is met slowly
and the force to be exerted rises from zero at the touch."""


def nonstrict_section(summaries: Summaries, pictures: Pictures) -> str:
    """Figure 11."""
    present = {name: alpha for name, alpha in NONSTRICT_RUNS.items() if name in summaries}
    if not present:
        return ""
    rows = []
    for name, alpha in present.items():
        errors = summaries[name]["phases"][-1]["errors"]
        rows.append([f"{alpha:g}", number(errors["end_effector"], 3), number(errors["elbow"], 3)])
    return "\n\n".join(
        [
            "## Figure 11: constant non-strict priorities (`nonstrict`)",
            table(["alpha_12", "end effector [m]", "elbow [m]"], rows),
            *_shown(
                pictures,
                [
                    (
                        "nonstrict.png",
                        "Figure 11: errors of the two tasks for three constant priorities.",
                    )
                ],
            ),
            _NONSTRICT_REASONS,
        ]
    )


_NONSTRICT_REASONS = """As in the paper: no task is reached, 0.5 is an equal compromise, and a
larger alpha_12 favours the elbow at the expense of the end effector. The sizes follow our
targets."""


def _phases(summary: Summary) -> str:
    units = summary["error_units"]
    rates = summary["peak_torque_rate_nm_per_s"]["per_phase"]
    rows = [
        [
            f"`{phase['hierarchy']}`",
            f"{phase['t_end']:g}",
            *(number(phase["errors"][task], 3) for task in units),
            f"{rate:.0f}",
        ]
        for phase, rate in zip(summary["phases"], rates, strict=True)
    ]
    period = 1e3 * summary["control_dt_s"]
    head = [
        "hierarchy",
        "until [s]",
        *(f"{task} [{unit}]" for task, unit in units.items()),
        f"torque rate [Nm/s at {period:g} ms]",
    ]
    return "Task errors at the end of each phase:\n\n" + table(head, rows)


def _shown(pictures: Pictures, wanted: list[tuple[str, str]]) -> list[str]:
    return [picture(file, caption) for file, caption in wanted if file in pictures]

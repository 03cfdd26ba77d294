"""Sections on insertion, tracking, contact force and non-strict priorities."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ghc_sim_bridge.programs.markdown import number, picture, table
from ghc_sim_bridge.programs.paper.pictures import NONSTRICT_RUNS
from ghc_sim_bridge.programs.paper.runs import PAPERS_OWN, beside

Summary = Mapping[str, Any]
Summaries = Mapping[str, Summary]
Pictures = frozenset[str]


def insertion_section(summaries: Summaries, pictures: Pictures) -> str:
    """Thesis, section 3.3.1."""
    runs = _both(summaries, "insertion_removal")
    if not runs:
        return ""
    return "\n\n".join(
        [
            "## Thesis, figure 3.2: insertion and removal of a task (`insertion_removal`)",
            _phases(runs),
            *_shown(
                pictures,
                "insertion_removal_tasks",
                "Thesis, figure 3.2: the end-effector task is inserted at the top and removed "
                "again.",
            ),
            _INSERTION_REASONS,
        ]
    )


_INSERTION_REASONS = """As in the thesis: the end-effector error falls to zero while its task is on
top, the elbow keeps what is left of its own, and no error jumps. The sizes follow our targets.
With `ghc` the wrist still swings at the end of the second phase."""


def lemniscate_section(summaries: Summaries, pictures: Pictures) -> str:
    """Figures 6 to 8."""
    runs = _both(summaries, "lemniscate")
    if not runs:
        return ""
    paper = next(iter(runs.values()))["paper"]
    kept = "; ".join(
        f"`{name}`: velocity {number(100.0 * run['limit_violations']['velocity'])} %, torque "
        f"{number(100.0 * run['limit_violations']['torque_bound'])} %, "
        f"{run['counts'].get('relaxed_ticks', '–')} ticks with a relaxed row"
        for name, run in runs.items()
    )
    return "\n\n".join(
        [
            "## Figures 6 to 8: tracking within velocity and torque bounds (`lemniscate`)",
            _phases(runs),
            f"Bounds: velocity {paper['velocity_limit_rad_per_s']:g} rad/s and torque "
            f"{paper['torque_limit_nm']:g} Nm, as in the paper. Largest excess: {kept}.",
            *_shown(
                pictures,
                "lemniscate_path",
                "Figure 6: desired and resulting path of the end effector.",
            ),
            *_shown(pictures, "lemniscate_tasks", "Figure 7: priorities and task errors."),
            *_shown(
                pictures,
                "lemniscate_joints",
                "Figure 8: joint velocities and torques with their bounds.",
            ),
            _LEMNISCATE_REASONS,
        ]
    )


_LEMNISCATE_REASONS = """Why they differ from the paper's: 1.5 Nm on the torques themselves, which
is what the paper prints, cannot hold this arm up: its shoulder needs some ten times that against
gravity. We take the reading under which the experiment is possible and the figure means the same:
the bound holds for what is commanded beyond gravity, |tau - g(q)| <= 1.5 Nm, in every joint. The
curve has the size and the period (2 pi s) of the paper's; its center is moved, since at the
paper's (0.40, 0, 0.40) m this arm folds onto the end stop of joint 4.

What the default costs here: in the second phase `cascade` takes the wrist through its straight
posture while velocity and torque bounds are active. Levels that are exact under bounds change
quickly there: torque rates are higher than with `ghc`, and the curve is reached later (figures 6
and 8). The later phases are calmer. The target moves all the time, and damping towards -kd v also
brakes the arm that follows it: the end effector stays farther behind than with `ghc`."""


def contact_section(summaries: Summaries, pictures: Pictures) -> str:
    """Figures 9 and 10."""
    runs = _both(summaries, "contact_force")
    if not runs:
        return ""
    task = next(iter(next(iter(runs.values()))["contact_force"]))
    forces = "; ".join(
        f"`{name}`: {_forces(run['contact_force'][task][-1])}" for name, run in runs.items()
    )
    return "\n\n".join(
        [
            "## Figures 9 and 10: contact force (`contact_force`)",
            _phases(runs),
            f"Force of `{task}` on the plane at the end. {forces}.",
            *_shown(
                pictures,
                "contact_force",
                "Figure 10: position errors, desired and resulting contact force.",
            ),
            _CONTACT_REASONS,
        ]
    )


_CONTACT_REASONS = """As in the paper: after the switch the end effector moves to the plane and,
once it touches, holds the desired normal force and its place within the plane (eq. 3). Why they
differ: the paper shows a peak of the force at the impact. Its size follows the softness of the
contact and the speed of the approach, which the paper does not state; here the plane is met slowly
and the force to be exerted rises from zero at the touch."""


def _forces(end: Mapping[str, Any]) -> str:
    axes = zip("xyz", end["desired_n"], end["measured_n"], strict=True)
    return ", ".join(
        f"{axis} desired {number(desired, 3)} N, resulting {number(measured, 4)} N"
        for axis, desired, measured in axes
        if desired != 0.0
    )


def nonstrict_section(summaries: Summaries, pictures: Pictures) -> str:
    """Figure 11."""
    rows = []
    for name, alpha in NONSTRICT_RUNS.items():
        for formulation, run in _both(summaries, name).items():
            errors = run["phases"][-1]["errors"]
            rows.append(
                [
                    f"{alpha:g}, `{formulation}`",
                    number(errors["end_effector"], 3),
                    number(errors["elbow"], 3),
                ]
            )
    if not rows:
        return ""
    return "\n\n".join(
        [
            "## Figure 11: constant non-strict priorities (`nonstrict`)",
            table(["alpha_12, formulation", "end effector [m]", "elbow [m]"], rows),
            *_shown(
                pictures,
                "nonstrict",
                "Figure 11: errors of the two tasks for three constant priorities.",
            ),
            _NONSTRICT_REASONS,
        ]
    )


_NONSTRICT_REASONS = """As in the paper: no task is reached, and a larger alpha_12 favors the elbow
at the expense of the end effector. 0.5 is an equal compromise with `cascade`. With `ghc`, whose
arm has not come to rest, the elbow is nearer. 0.2 and 0.8 are neither an order nor on the way
between two, so `cascade` answers them as `balanced` does. The sizes follow our targets."""


def _both(summaries: Summaries, name: str) -> dict[str, Summary]:
    """Runs of one experiment by formulation: the default first, then the paper's."""
    names = (name, beside(name))
    return {summaries[run]["formulation"]: summaries[run] for run in names if run in summaries}


def _phases(runs: Mapping[str, Summary]) -> str:
    first = next(iter(runs.values()))
    units = first["error_units"]
    rows = [
        [
            f"`{phase['hierarchy']}`, `{name}`",
            f"{phase['t_end']:g}",
            *(number(phase["errors"][task], 3) for task in units),
            f"{run['peak_torque_rate_nm_per_s']['per_phase'][k]:.0f}",
            _speed_left(run, k),
        ]
        for k in range(len(first["phases"]))
        for name, run in runs.items()
        for phase in [run["phases"][k]]
    ]
    period = 1e3 * first["control_dt_s"]
    head = [
        "hierarchy, formulation",
        "until [s]",
        *(f"{task} [{unit}]" for task, unit in units.items()),
        f"torque rate [Nm/s at {period:g} ms]",
        "joint speed left [rad/s]",
    ]
    return "Task errors at the end of each phase:\n\n" + table(head, rows)


def _speed_left(run: Summary, phase: int) -> str:
    """Mean speed of the fastest joint at the end of a phase; a dash for moving references."""
    rest = run["rest"]
    return number(rest["mean_speed_rad_per_s"][phase] if rest["references_rest"][phase] else None)


def _shown(pictures: Pictures, name: str, caption: str) -> list[str]:
    """A figure of the run with the default formulation, and of the run with the paper's."""
    wanted = ((name, caption), (beside(name), f"The same with `{PAPERS_OWN}`."))
    return [picture(f"{file}.png", text) for file, text in wanted if f"{file}.png" in pictures]

"""Conflicting tasks, new targets and priorities all the time: do the limits hold?"""

from __future__ import annotations

from typing import Any, NamedTuple

from benchmarks.models import install_model
from benchmarks.study_results import shown
from benchmarks.targets.limit_loop import Loop, run_loop
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "aggressive_loop"
TITLE = "Conflicting tasks under aggressive changes, torque rate limit on"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")


class Case(NamedTuple):
    """A loop, for how long and how often it runs."""

    loop: Loop
    duration: float  # [s]
    seeds: tuple[int, ...]
    others: tuple[int, ...] = ()  # seeds of the formulations that are not the default


STIFF = Loop("kuka_stiff", "kuka_lwr", 300)
STIFFER = Loop("kuka_stiffer", "kuka_lwr", 300, torque_rate=500.0)
SOFT = Loop("kuka_soft", "kuka_lwr", 2000)
ARMS = Loop("icub_arms", "icub_standing", 300, standing=3, center="chest", reach=(0.1, 0.5))
_CASES = (
    Case(STIFF, 60.0, tuple(range(10)), (0,)),
    Case(STIFFER, 60.0, (0, 1)),
    Case(SOFT, 60.0, (4,)),
    Case(ARMS, 10.0, (0, 1)),
)
_QUICK = (Case(STIFF, 0.6, (0,), (0,)),)


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Closed loop per formulation, case and seed."""
    cases = _QUICK if quick else _CASES
    if not quick:
        install_model("icub-models")
    found: dict[str, Any] = {name: {} for name in formulations}
    for name in formulations:
        for case in cases:
            seeds = case.seeds if name == FORMULATIONS[0] else case.others
            rows = {str(seed): run_loop(case.loop, name, seed, case.duration) for seed in seeds}
            if rows:
                found[name][case.loop.robot] = rows
    facts = [case._asdict() | {"loop": case.loop._asdict()} for case in cases]
    return {"facts": {"cases": facts}, "formulations": found}


def table(result: dict[str, Any]) -> str:
    """One line per formulation, robot and seed."""
    lines = []
    for name, cases in result["formulations"].items():
        for robot, seeds in cases.items():
            for seed, row in seeds.items():
                ticks = sum(row["status"].values())
                lines.append(
                    [
                        *(name, robot, seed),
                        shown(row["position_excess_rad"]),
                        shown(row["velocity_excess_percent"], ".2g"),
                        f"{100.0 * row['status']['RELAXED'] / ticks:.2g}",
                        str(row["status"]["FALLBACK"]),
                        shown(row["largest_torque_step_nm"]),
                        str(row["refused_transitions"]),
                        "-" if row["ended_at_s"] is None else f"{row['ended_at_s']:g} s",
                    ]
                )
    head = ["formulation", "robot", "seed", "position excess [rad]", "velocity excess [%]"]
    head += ["RELAXED [% of ticks]", "FALLBACK", "largest torque step [Nm per 1 ms]", "refused"]
    return (
        "Closed loop at 1 ms, default settings (torque rate limit on, 1000 Nm/s). New random "
        "priorities every 0.3 s in 0 to 0.3 s; new targets, many out of reach, every 0.3 s. "
        "`kuka_stiff`: KUKA, five tasks, 400 1/s^2 and 40 1/s, 60 s. `kuka_stiffer`: 1600, 80, "
        "rate limit 500 Nm/s, 60 s. `kuka_soft`: 30, 20, targets every 2 s, 60 s. `icub_arms`: "
        "iCub on both feet, hands, elbows and posture of the arms at 400, 40 below center of "
        "mass, pelvis and chest, in random orders only, 10 s; all joints count. Goals of the "
        "default: at most 1e-4 rad, 1 % and 0.1 % RELAXED (`kuka_stiffer`: 1e-3 rad, 5 %), no "
        "FALLBACK. Refused: transitions that leave eq. 13b without a solution. Ended: diverged, "
        "or the robot fell.\n\n" + markdown_table([*head, "ended"], lines)
    )

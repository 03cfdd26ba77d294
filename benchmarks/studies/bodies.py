"""Two arms and iCub: distances of bodies over random targets, and margins that are switched on."""

from __future__ import annotations

from typing import Any

from benchmarks.bodies.loop import LOOPS, run_loop
from benchmarks.bodies.switch_on import switch_on
from benchmarks.models import install_model
from benchmarks.study_results import shown
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "bodies"
TITLE = "Distances of bodies, two arms and iCub"
FORMULATIONS = ("cascade",)
GOAL_BELOW = 1e-3  # [m]
GOAL_RATIO = 10.0  # [-]
_SEEDS = (0, 1)
_CONTACT_SEEDS = (0, 1, 2)
_DURATION = 60.0  # [s]
_FREE = 20.0  # [s] without the constraint


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Random targets with and without the constraint, then margins that rise, raw and smoothed."""
    seeds, contact_seeds = ((0,), (0,)) if quick else (_SEEDS, _CONTACT_SEEDS)
    duration = 0.05 if quick else _DURATION
    names = ("two_arms",) if quick else tuple(LOOPS)
    if not quick:
        install_model("icub-models")
    found: dict[str, Any] = {}
    for formulation in formulations:
        found[formulation] = {name: {} for name in names}
        for name in names:
            loop, mine = LOOPS[name], found[formulation][name]
            mine["targets"] = {
                str(seed): run_loop(loop, formulation, seed, duration) for seed in seeds
            }
            mine["free"] = run_loop(
                loop, formulation, seeds[0], min(duration, _FREE), constrained=False
            )
            mine["contacts"] = (
                {}
                if quick
                else {str(seed): switch_on(loop, formulation, seed) for seed in contact_seeds}
            )
    return {"facts": {"duration_s": duration, "seeds": list(seeds)}, "formulations": found}


def table(result: dict[str, Any]) -> str:
    """Distances, then torque rates."""
    rows, contacts = [], []
    for formulation, robots in result["formulations"].items():
        for robot, mine in robots.items():
            runs = [(seed, "on", row) for seed, row in mine["targets"].items()]
            runs.append((str(result["facts"]["seeds"][0]), "off", mine["free"]))
            rows += [[formulation, robot, seed, on, *_cells(row)] for seed, on, row in runs]
            contacts += [
                [
                    *(formulation, robot, seed),
                    shown(row["raw_nm_per_s"], ".0f"),
                    shown(row["smoothed_nm_per_s"], ".1f"),
                    f"{row['ratio']:.0f}",
                    shown(1e3 * row["left_of_rise_m"], ".1f"),
                ]
                for seed, row in mine["contacts"].items()
            ]
    head = ["formulation", "robot", "seed", "constraint", "below the margin [mm]", "pair"]
    head += ["pairs", "of these within 1 cm of it", "time at a margin [%]"]
    head += ["largest torque step [Nm]", "relaxed, braking", "CPU per step [ms]"]
    second = ["formulation", "robot", "seed", "raw [Nm/s]", "smoothed [Nm/s]", "ratio"]
    second += ["left of the rise after 2.5 s [mm]"]
    return (
        "Both hands get new random targets every 1.5 s in one space, for "
        f"{result['facts']['duration_s']:g} s ({_FREE:g} s without the constraint), with the "
        "torque rate limit on. Distances are those of Pinocchio's collision library (coal), every "
        "5 ms. Goal: at most "
        f"{1e3 * GOAL_BELOW:g} mm below a margin.\n\n{markdown_table(head, rows)}\n\n"
        "Both hands stand beside each other; the margin between the arms is raised 5 cm above "
        "their distance without notice. Largest torque rate at a control period of 1 ms, rate "
        f"limit off, without and with the generator `body_margins`. Goal: ratio at least "
        f"{GOAL_RATIO:g}.\n\n{markdown_table(second, contacts)}"
    )


def _cells(row: dict[str, Any]) -> list[str]:
    status = row["status"]
    return [
        f"{1e3 * row['below_margin_m']:.2f}",
        row["worst_pair"],
        str(row["pairs"]),
        str(row["pairs_within_1_cm"]),
        f"{100.0 * row['active_share']:.0f}",
        shown(row["largest_torque_step_nm"], ".3f"),
        f"{status['RELAXED']}, {status['FALLBACK']}",
        f"{row['step_cpu_ms']:.2f}",
    ]

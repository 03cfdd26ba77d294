"""KUKA, five conflicting tasks, new targets and priorities all the time: do the limits hold?"""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.models import STUDY_ROBOTS
from benchmarks.random_tasks import random_matrix
from benchmarks.study_results import shown
from ghc_controller.errors import InvalidValue
from ghc_controller.types import Array
from ghc_sim_bridge import SimulationDiverged, Simulator
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "aggressive_loop"
TITLE = "KUKA, five conflicting tasks under aggressive changes, default rate limit"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")
_PERIOD = 300  # [ms] between new priorities
_DURATIONS = (0.0, 0.005, 0.05, 0.1, 0.3)  # [s] of the transitions
_CENTER = np.array([0.0, 0.0, 0.3])  # [m] of the shell that position targets come from


class Case(NamedTuple):
    """Gains, and how often the targets change."""

    robot: str
    targets_every: int  # [ms]
    seeds: tuple[int, ...]


_CASES = (Case("kuka_stiff", 300, (0, 1, 2, 3, 4)), Case("kuka_soft", 2000, (4,)))
_QUICK = (Case("kuka_stiff", 300, (0,)),)


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """60 s of closed loop per case and seed."""
    duration, cases = (0.6, _QUICK) if quick else (60.0, _CASES)
    facts = {"duration_s": duration, "cases": [case._asdict() for case in cases]}
    found = {
        name: {
            case.robot: {str(seed): _loop(case, name, seed, duration) for seed in case.seeds}
            for case in cases
        }
        for name in formulations
    }
    return {"facts": facts, "formulations": found}


def _loop(case: Case, formulation: str, seed: int, duration: float) -> dict[str, Any]:
    controller = ghc.Controller.for_robot(
        STUDY_ROBOTS / f"{case.robot}.yaml", ghc.Settings(formulation=formulation)
    )
    model = controller.model
    simulator = Simulator("kuka_lwr", joint_names=model.joint_names)
    rng = np.random.default_rng(seed)
    status: Counter[str] = Counter({s.name: 0 for s in ghc.StepStatus})
    beyond, too_fast, too_strong, refused = -np.inf, -np.inf, -np.inf, 0
    steps: list[float] = []
    previous: Array | None = None
    diverged: float | None = None
    for tick in range(round(1e3 * duration)):
        state = simulator.state()
        if tick % _PERIOD == 0:
            refused += not _change_priorities(controller, state.time, rng)
        if tick % case.targets_every == 0:
            controller.observe(state)
            for reference in _targets(controller, state.time, rng):
                controller.add_reference(reference)
        result = controller.step(state)
        status[result.status.name] += 1
        torque = result.torque.copy()
        too_strong = max(too_strong, float(np.max(np.abs(torque) - model.torque_limit)))
        if previous is not None:
            steps.append(float(np.abs(torque - previous).max()))
        previous = torque
        try:
            simulator.step(torque)
        except SimulationDiverged:
            diverged = state.time
            break
        after = simulator.state()
        outside = np.maximum(after.q - model.position_upper, model.position_lower - after.q)
        beyond = max(beyond, float(outside.max()))
        too_fast = max(too_fast, float(np.max(np.abs(after.v) / model.velocity_limit - 1.0)))
    return {
        "status": dict(status),
        "position_excess_rad": max(0.0, beyond),
        "velocity_excess_percent": max(0.0, 100.0 * too_fast),
        "torque_excess_nm": max(0.0, too_strong),
        "largest_torque_step_nm": max(steps),
        "refused_transitions": refused,
        "diverged_at_s": diverged,
    }


def _change_priorities(controller: ghc.Controller, now: float, rng: np.random.Generator) -> bool:
    names = controller.robot.task_names
    matrix = ghc.PriorityMatrix(names, random_matrix(rng, len(names))[0])
    transition = ghc.Transition(matrix, now, float(rng.choice(_DURATIONS)))
    try:
        controller.add_transition(transition, now)
    except InvalidValue:  # eq. 13b would lose its solution
        return False
    return True


def _targets(
    controller: ghc.Controller, now: float, rng: np.random.Generator
) -> list[ghc.ReferenceTrajectory]:
    model, found = controller.model, []
    for task in controller.robot.tasks:
        if task.name == "posture":
            target = rng.uniform(model.position_lower * 1.05, model.position_upper * 1.05)
        elif task.name == "tool_orientation":
            target = rng.normal(size=4)
            target /= np.linalg.norm(target)
        else:
            target = rng.normal(size=3)
            target = target / np.linalg.norm(target) * rng.uniform(0.2, 1.1) + _CENTER
        found.append(ghc.ReferenceTrajectory.static(task, task.static_target(target), now))
    return found


def table(result: dict[str, Any]) -> str:
    """One line per formulation, gains and seed."""
    lines = []
    for name, cases in result["formulations"].items():
        for robot, seeds in cases.items():
            for seed, row in seeds.items():
                lines.append(
                    [
                        *(name, robot, seed),
                        shown(row["position_excess_rad"]),
                        shown(row["velocity_excess_percent"], ".0f"),
                        *(str(row["status"][key]) for key in ("RELAXED", "FALLBACK")),
                        shown(row["largest_torque_step_nm"]),
                        str(row["refused_transitions"]),
                        "-" if row["diverged_at_s"] is None else f"{row['diverged_at_s']:g} s",
                    ]
                )
    head = ["formulation", "gains", "seed", "position excess [rad]", "velocity excess [%]"]
    head += ["RELAXED", "FALLBACK", "largest torque step [Nm per 1 ms]", "refused", "diverged"]
    duration = result["facts"]["duration_s"]
    return (
        f"{duration:g} s of closed loop, default settings (torque rate limit on). New random "
        "priorities every 0.3 s in 0 to 0.3 s; new targets, many out of reach, every 0.3 s "
        "(stiff: 400 1/s^2, 40 1/s) or 2 s (soft: 30, 20). Refused: transitions that leave "
        "eq. 13b without a solution.\n\n" + markdown_table(head, lines)
    )

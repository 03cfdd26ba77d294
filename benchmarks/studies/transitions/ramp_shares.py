"""KUKA and iCub: how much of a change of priorities happens in one of 100 equal steps?"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.icub_states import TenTasks, begin, icub_controller, ten_task_states
from benchmarks.ramps.share_ramps import KINDS, STEPS, Ramp, follow, orders_of
from benchmarks.random_tasks import Reach, random_references, strict_matrix
from benchmarks.study_results import shown, spread
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "ramp_shares"
TITLE = "Ramps of 100 equal steps, state held"
FORMULATIONS = ("cascade", "balanced", "ghc")
_SEED = 1
_STATES = {"kuka_lwr": 24, "icub": 8}
_QUICK = {"kuka_lwr": 1}
_SPREAD = 0.6  # [rad] postures of the arm, about the one of its file


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Each state goes through every kind of ramp."""
    states = _QUICK if quick else _STATES
    facts = {"states": states, "seed": _SEED, "steps": STEPS, "kinds": list(KINDS)}
    found = {
        name: {robot: _of_robot(robot, name, count) for robot, count in states.items()}
        for name in formulations
    }
    return {"facts": facts, "formulations": found}


def _of_robot(robot: str, formulation: str, count: int) -> dict[str, Any]:
    rng = np.random.default_rng(_SEED)
    if robot == "icub":
        controller = icub_controller(formulation)
        cases = list(ten_task_states(icub_controller("hqp"), count))
    else:
        settings = ghc.Settings(formulation=formulation, torque_rate_limit=0.0)
        controller = ghc.Controller.for_robot(robot, settings)
        cases = list(_arm_states(controller, count))
    ramps: dict[str, list[Ramp]] = {kind: [] for kind in KINDS}
    for case in cases:
        state = ghc.RobotState(0.0, case.q, np.zeros(controller.model.nv))
        for kind in KINDS:
            orders = orders_of(kind, case.order, rng)
            begin(controller, case, strict_matrix(case.order, len(case.order)))
            ramps[kind] += follow(controller, state, orders)
    return {kind: _summary(of_kind) for kind, of_kind in ramps.items()}


def _arm_states(controller: ghc.Controller, count: int) -> Iterator[TenTasks]:
    """Postures and targets of the arm in random strict order."""
    rng = np.random.default_rng(_SEED)
    robot = controller.robot
    for _ in range(count):
        middle = robot.tasks[-1].default_target(controller.model).position
        q = middle + rng.uniform(-_SPREAD, _SPREAD, len(middle))
        controller.observe(ghc.RobotState(0.0, q, np.zeros_like(q)))
        references = random_references(robot, rng, Reach())
        order = tuple(int(task) for task in rng.permutation(len(robot.tasks)))
        yield TenTasks(q, tuple(references), order)


def _summary(ramps: list[Ramp]) -> dict[str, Any]:
    shares = [100.0 * ramp.largest_share for ramp in ramps if np.isfinite(ramp.largest_share)]
    return {
        "ramps": len(ramps),
        "largest_percent": spread(shares),
        "judged": len(shares),
        "with_unsolved_steps": sum(ramp.unsolved > 0 for ramp in ramps),
    }


def table(result: dict[str, Any]) -> str:
    """Largest step by robot and kind of ramp."""
    facts, lines = result["facts"], []
    for name, robots in result["formulations"].items():
        for robot, kinds in robots.items():
            for kind in facts["kinds"]:
                row = kinds[kind]
                share = row["largest_percent"]
                figures = [shown(share[key]) for key in ("median", "p95", "max")]
                judged = f"{row['judged']} of {row['ramps']}"
                lines.append(
                    [name, robot, kind, *figures, judged, str(row["with_unsolved_steps"])]
                )
    where = ", ".join(f"{count} ({robot})" for robot, count in facts["states"].items())
    head = ["formulation", "robot", "ramp", "median [%]", "p95 [%]", "max [%]", "judged"]
    return (
        "Largest of 100 equal steps as a share of the whole change of torque (largest joint): 1 % "
        f"where torque is linear in the ramp. State held; {where} states with random "
        f"targets and orders (seed {facts['seed']}; iCub: the first ones of `icub_ten_tasks`). "
        "Cycle: three ramps that bring the first task to the third place and back. Pre-empted: "
        "a ramp replaced half-way. Judged: every step SOLVED, and a change above 1 mNm; three "
        "unsolved steps end a ramp.\n\n"
        + markdown_table([*head, "ramps with unsolved steps"], lines)
    )

"""Transitions that are given a torque-rate budget instead of a duration."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.icub_states import SCENE, icub_controller, ten_task_states
from benchmarks.models import STUDY_ROBOTS
from benchmarks.ramps.budget_ramps import PERIOD, Case, follow, shortest, whole_change
from benchmarks.random_tasks import Reach, random_references
from benchmarks.study_results import shown, shown_spread, spread
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "budgets"
TITLE = "Transitions with a torque-rate budget"
FORMULATIONS = ("cascade",)
_SEED = 31
_SIZES = {"kuka_lwr": (60, 60), "icub": (60, 20)}  # cases standing still, cases moving
_QUICK = {"kuka_lwr": (2, 0), "icub": (0, 0)}
_KINDS = ("swap", "insertion", "removal")
_LONGEST = 1.5  # [s] for which a budget is chosen; smaller ones are raised to that
_LEAST_CHANGE = 0.2  # [Nm] between the two answers: below it there is no ramp to speak of


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Budgets of 10 to 1000 Nm/s, drawn evenly in their logarithm."""
    sizes = _QUICK if quick else _SIZES
    facts = {"cases": sizes, "seed": _SEED, "longest_s": _LONGEST}
    found = {name: _of_formulation(name, sizes) for name in formulations}
    return {"facts": facts, "formulations": found}


def _of_formulation(formulation: str, sizes: dict[str, tuple[int, int]]) -> dict[str, Any]:
    found = {}
    for robot, (still, moving) in sizes.items():
        if still + moving == 0:
            continue
        controller = _controller(robot, formulation)
        rng = np.random.default_rng(_SEED)
        for word, count in (("still", still), ("moving", moving)):
            if count:
                cases = _cases(controller, robot, word == "moving", rng)
                found[f"{robot}, {word}"] = _measure(controller, cases, count, rng)
    return found


def _controller(robot: str, formulation: str) -> ghc.Controller:
    if robot == "icub":
        return icub_controller(formulation)
    settings = ghc.Settings(formulation=formulation, torque_rate_limit=0.0)
    return ghc.Controller.for_robot(STUDY_ROBOTS / "kuka_soft.yaml", settings)


def _cases(
    controller: ghc.Controller, robot: str, moving: bool, rng: np.random.Generator
) -> Iterator[Case]:
    """Random states, targets and changes of order, without end."""
    scene = {"icub": SCENE, "kuka_lwr": "kuka_lwr"}[robot] if moving else ""
    model, k = controller.model, len(controller.robot.tasks)
    states = ten_task_states(controller, 10**6) if robot == "icub" else None
    while True:
        if states is None:
            q = rng.uniform(0.7 * model.position_lower, 0.7 * model.position_upper)
            controller.observe(ghc.RobotState(0.0, q, np.zeros(model.nv)))
            references = random_references(controller.robot, rng, Reach())
        else:
            state = next(states)
            q, references = state.q, list(state.references)
        order = list(rng.permutation(k))
        a, b = sorted(rng.choice(k, size=2, replace=False))
        kind = _KINDS[rng.integers(len(_KINDS))]
        swapped = list(order)
        swapped[a], swapped[b] = swapped[b], swapped[a]
        without = [task for task in order if task != order[a]]
        begin, goal = {
            "swap": (order, swapped),
            "insertion": (without, order),
            "removal": (order, without),
        }[kind]
        yield Case(q, references, begin, goal, scene, 0.2 if moving else PERIOD)


def _measure(
    controller: ghc.Controller, cases: Iterator[Case], count: int, rng: np.random.Generator
) -> dict[str, Any]:
    over, longer, durations, budgets = [], [], [], []
    stalled = 0
    while len(over) < count:
        case = next(cases)
        change = whole_change(controller, case)
        if not change > _LEAST_CHANGE:  # also where an answer is missing
            continue
        budget = max(10.0 ** rng.uniform(1.0, 3.0), change / _LONGEST)
        way = follow(controller, case, 0.0, budget)
        stalled += not np.isfinite(way.duration)
        over.append(way.added / budget)
        best = shortest(controller, case, budget, way.duration)
        longer.append(way.duration / best)
        durations.append(way.duration)
        budgets.append(budget)
    return {
        "added_over_budget": spread(over),
        "duration_over_shortest": spread(longer),
        "duration_s": spread(durations),
        "budget_nm_per_s": spread(budgets),
        "stalled": stalled,
    }


def table(result: dict[str, Any]) -> str:
    """Markdown of a result of `run`."""
    rows = [
        [
            name,
            where,
            shown_spread(row["added_over_budget"]),
            shown_spread(row["duration_over_shortest"]),
            shown_spread(row["duration_s"]),
            shown(row["budget_nm_per_s"]["median"]),
            str(row["stalled"]),
        ]
        for name, groups in result["formulations"].items()
        for where, row in groups.items()
    ]
    cases = ", ".join(
        f"{robot} {still} + {moving}"
        for robot, (still, moving) in result["facts"]["cases"].items()
    )
    return (
        f"Random swaps, insertions and removals, standing still + moving: {cases} "
        f"(seed {result['facts']['seed']}), budgets of 10 to 1000 Nm/s at a control period of "
        "1 ms, raised where the ramp would take more than "
        f"{result['facts']['longest_s']} s. Added: the change of torque by the shares alone, "
        "every order solved once more at the state of the step. Shortest: linear ramp of a fixed "
        "duration that adds no more, by bisection. Median / p95 / max.\n\n"
        + markdown_table(
            [
                "formulation",
                "robot",
                "added over budget",
                "duration over the shortest",
                "duration [s]",
                "budget, median [Nm/s]",
                "stalled",
            ],
            rows,
        )
    )

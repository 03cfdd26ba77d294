"""Random problems with active bounds: difference of a formulation from a hard cascade."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.bounded_problems import SEED, SIZES, bounded_problems
from benchmarks.problems.problem_check import violation
from benchmarks.problems.reference_cascade import Damping
from benchmarks.study_results import shown, shown_spread, spread
from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "random_bounded"
TITLE = "Random problems with active bounds"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp", "weighted")
_PROBLEMS, _QUICK = 200, 6
_FELT = 1e-6  # [-] of |b|: bounds cost a level more than this


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Excess over the reference of the same damping, of |b|, at levels 1, 2 and below."""
    from reference.hard_cascade import kept_damping

    count = _QUICK if quick else _PROBLEMS
    settings = ghc.Settings().optimization
    w = settings.regularization
    solvers = {name: make_formulation(name, settings) for name in formulations}
    status = {name: Counter({s.name: 0 for s in SolutionStatus}) for name in formulations}
    rules: dict[str, float | Damping] = {
        name: kept_damping(w) if name == "cascade" else w for name in formulations
    }
    excess: dict[str, list[list[float]]] = {name: [] for name in formulations}
    worst = dict.fromkeys(formulations, 0.0)
    felt = infeasible = 0
    for case in bounded_problems(count, w):
        reference, free = case.hard_cascade(w), case.hard_cascade(w, bounded=False)
        assert free is not None
        size = np.array([np.linalg.norm(target) for target in case.targets])
        if reference is None:
            infeasible += 1
            continue
        felt += bool(((reference[1] - free[1]) / size)[:2].max() > _FELT)
        references = {rule: case.hard_cascade(rule) for rule in set(rules.values())}
        problem = case.control_problem()
        for name, formulation in solvers.items():
            solution = formulation.solve(problem)
            status[name][solution.status.name] += 1
            if solution.status is not SolutionStatus.SOLVED:
                continue
            worst[name] = max(worst[name], violation(problem, solution))
            residuals = [
                np.linalg.norm(J @ solution.acceleration - b)
                for J, b in zip(case.jacobians, case.targets, strict=True)
            ]
            same = references[rules[name]]
            assert same is not None
            gap = (np.array(residuals) - same[1]) / size
            excess[name].append([gap[0], gap[1], gap[2:].max()])
    facts = {
        "problems": count,
        "seed": SEED,
        "joints": list(SIZES),
        "w": w,
        "bounds_cost_level_1_or_2": felt,
        "reference_finds_none": infeasible,
    }
    found = {}
    for name in formulations:
        levels = np.array(excess[name]).reshape(-1, 3)
        found[name] = {
            "status": dict(status[name]),
            "worst_violation": worst[name],
            "excess": {
                level: spread(levels[:, i]) for i, level in enumerate(("1", "2", "3 and below"))
            },
        }
    return {"facts": facts, "formulations": found}


def table(result: dict[str, Any]) -> str:
    """Excess by level and formulation."""
    facts, lines = result["facts"], []
    for name, row in result["formulations"].items():
        unsolved = sum(count for key, count in row["status"].items() if key != "SOLVED")
        cells = [shown_spread(values) for values in row["excess"].values()]
        lines.append([name, *cells, shown(row["worst_violation"], ".1e"), str(unsolved)])
    head = ["formulation", *(f"level {level}" for level in ("1", "2", "3 and below"))]
    head += ["worst violation [rad/s^2, Nm]", "not SOLVED"]
    return (
        f"{facts['problems']} well-scaled problems in strict order (seed {facts['seed']}; "
        f"{', '.join(map(str, facts['joints']))} joints in turn, 3 to 6 levels), each with an "
        f"active bound; in {facts['bounds_cost_level_1_or_2']} bounds cost level 1 or 2 "
        "something. Excess of the residual over an independent hard cascade of the same damping, "
        "as a share of the level's target: median / p95 / max.\n\n" + markdown_table(head, lines)
    )

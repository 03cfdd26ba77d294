"""iCub standing, ten tasks in random strict order: is every feasible problem solved?"""

from __future__ import annotations

from collections import Counter
from time import thread_time
from typing import Any

import ghc_controller as ghc
from benchmarks.icub_states import SEED, icub_controller, ten_task_problem, ten_task_states
from benchmarks.problems.problem_check import is_feasible, violation
from benchmarks.study_results import shown, spread
from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_sim_bridge.programs.markdown import table as markdown_table

NAME = "icub_ten_tasks"
TITLE = "iCub standing, ten tasks in random strict order"
FORMULATIONS = ("cascade", "balanced", "ghc", "hqp")
_STATES, _QUICK = 200, 2


def run(quick: bool, formulations: tuple[str, ...]) -> dict[str, Any]:
    """Every formulation on the same problems; feasibility by an independent linear program."""
    count = _QUICK if quick else _STATES
    controller = icub_controller("hqp")  # it only sets up the problems
    settings = ghc.Settings().optimization
    solvers = {name: make_formulation(name, settings) for name in formulations}
    status = {name: Counter({s.name: 0 for s in SolutionStatus}) for name in formulations}
    wrong = dict.fromkeys(formulations, 0)
    worst = dict.fromkeys(formulations, 0.0)
    times: dict[str, list[float]] = {name: [] for name in formulations}
    feasible = 0
    for number, case in enumerate(ten_task_states(controller, count)):
        problem = ten_task_problem(controller, case)
        possible = is_feasible(problem)
        feasible += possible
        for name, formulation in solvers.items():
            if number == 0:
                formulation.solve(problem)  # workspaces are made outside the timing
            begin = thread_time()
            solution = formulation.solve(problem)
            times[name].append(1e3 * (thread_time() - begin))
            status[name][solution.status.name] += 1
            if solution.status is SolutionStatus.SOLVED:
                worst[name] = max(worst[name], violation(problem, solution))
            else:
                wrong[name] += possible
    facts = {"states": count, "seed": SEED, "feasible": feasible}
    return {
        "facts": facts,
        "formulations": {
            name: {
                "status": dict(status[name]),
                "wrong": wrong[name],
                "worst_violation": worst[name],
                "cpu_ms": spread(times[name]),
            }
            for name in formulations
        },
    }


def table(result: dict[str, Any]) -> str:
    """Statuses, wrong answers and violations by formulation."""
    facts = result["facts"]
    lines = []
    for name, row in result["formulations"].items():
        counts = [str(row["status"][status.name]) for status in SolutionStatus]
        cpu = row["cpu_ms"]
        lines.append(
            [
                *(name, *counts, str(row["wrong"]), shown(row["worst_violation"], ".1e")),
                f"{shown(cpu['median'])} / {shown(cpu['p95'])} / {shown(cpu['max'])}",
            ]
        )
    head = ["formulation", *(status.name for status in SolutionStatus), "wrong"]
    head += ["worst violation of SOLVED [rad/s^2, Nm, N]", "CPU median / p95 / max [ms]"]
    return (
        f"{facts['states']} states at rest (seed {facts['seed']}), arms, torso and neck moved, "
        "targets up to 0.3 m and 0.6 rad away; "
        f"an independent linear program finds {facts['feasible']} of them feasible. "
        "Wrong = feasible but not SOLVED.\n\n" + markdown_table(head, lines)
    )

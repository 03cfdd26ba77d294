"""iCub standing with ten tasks in random strict order: one control problem at a time."""

from __future__ import annotations

import copy

import numpy as np

import ghc_controller as ghc
from benchmarks.compare.case import Result
from benchmarks.compare.method import Method
from benchmarks.compare.operations import law_operations
from benchmarks.compare.qp_counter import QpCounter
from benchmarks.compare.runs.closed_loop import Change
from benchmarks.compare.runs.probes import LEAST_TARGET, ramp_step, strictness
from benchmarks.icub_states import begin, icub_controller, ten_task_states
from benchmarks.random_tasks import strict_matrix
from ghc_controller.formulations import SolutionStatus
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.types import Array

_STATES, _QUICK = 50, 4
_RAMPS = 5  # states at which the first two tasks change places
_FEET = 12  # accelerations that two soles keep at rest


def run_ten_tasks(method: Method, quick: bool) -> Result:
    """Two steps at each state, the second is measured; errors are abs(J x - b) / abs(b).

    `end` is the median over the states, `mean` their mean; level l is the l-th task of a state.
    """
    controller = icub_controller(method.formulation)
    settings = method.settings()
    k, d = len(controller.robot.tasks), controller.model.nv - _FEET
    counter = QpCounter(controller)
    problems, misses, counts, changes = [], [], [], []
    unsolved = 0
    for number, case in enumerate(ten_task_states(controller, _QUICK if quick else _STATES)):
        alpha = strict_matrix(case.order, k)
        begin(controller, case, alpha)
        still = np.zeros(controller.model.nv)
        for time in (0.0, 1e-3):
            counter.take()
            result = controller.step(ghc.RobotState(time, case.q, still))
        law = law_operations(method.formulation, d, controller.stack.starts, _alone(alpha))
        qps, pivots, operations = counter.take()
        counts.append((qps, pivots, operations + law))
        problems.append(copy.deepcopy(controller.problem()))
        unsolved += result.status is not ghc.StepStatus.SOLVED
        if result.solution.status is not SolutionStatus.FAILED:
            misses.append(_misses(problems[-1], case.order, result.solution.acceleration))
        if number < _RAMPS:
            first, second, *rest = case.order
            swapped = strict_matrix((second, first, *rest), k)
            changes.append(Change(problems[-1], alpha, swapped))
    strict = strictness(method.formulation, settings, problems)
    per_step = np.mean(counts, axis=0)
    median, mean, most = (f(misses, axis=0) for f in (np.median, np.mean, np.max))
    tasks = [
        {
            "level": level + 1,
            "task": f"task {level + 1}",
            "end": float(median[level]),
            "mean": float(mean[level]),
            "max": float(most[level]),
        }
        for level in range(k)
    ]
    return {
        "phases": [{"hierarchy": "random", "tasks": tasks}],
        "qps": float(per_step[0]),
        "pivots": float(per_step[1]),
        "operations": float(per_step[2]),
        "steps": len(problems),
        "unsolved": unsolved,
        "strict_first": strict.first,
        "strict_any": strict.any_level,
        "strict_free": strict.free,
        "ramp_step": ramp_step(method.formulation, settings, changes),
    }


def _alone(alpha: Array) -> list[Candidate]:
    return [Candidate(alpha, 1.0)]


def _misses(problem: ghc.ControlProblem, order: tuple[int, ...], x: Array) -> list[float]:
    found = []
    for task in order:
        rows = slice(problem.starts[task], problem.starts[task + 1])
        wanted = problem.target[rows]
        left = np.linalg.norm(problem.jacobian[rows] @ x - wanted)
        found.append(float(left) / max(float(np.linalg.norm(wanted)), LEAST_TARGET))
    return found

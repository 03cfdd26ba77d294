"""The torque rate limit: it bounds how fast torques approach the solution of the levels.

With the rate limit among its bounds, a strict level would sacrifice all lower levels, damping
included, for the small change that one period allows: an arm whose targets conflict then keeps
oscillating at the limit (`make study ARGS=conflicts`). The levels are therefore solved without it,
and their blend is approached as far as it allows, in a metric graded by the priorities.
"""

from __future__ import annotations

from dataclasses import replace

from ghc_controller.core import native
from ghc_controller.formulations.cascade.force_center import ForceCenter
from ghc_controller.formulations.cascade.level_answers import reduced_acceleration
from ghc_controller.formulations.formulation import FormulationSettings
from ghc_controller.formulations.nearest_answer import metric_factor
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.qp import VIOLATION_TOLERANCE, QpSolver


def without_rate(problem: ControlProblem) -> ControlProblem:
    """The problem with the torque limits alone."""
    return replace(problem, torque=problem.torque_limit)


def within_rate(
    reduced: ReducedProblem,
    forces: ForceCenter,
    answer: Solution,
    settings: FormulationSettings,
    solver: QpSolver,
) -> Solution:
    """Answer of the levels where it meets the torque rate limit; else the nearest one that does.

    min 1/2 (y - y*)^T W (y - y*) + 1/2 |s_f|^2 subject to every bound, W = sum_i gamma_i J_i^T J_i
    + I with weights graded by the priorities; forces balance y and s_f moves them from those of
    the answer.
    """
    box = reduced.source.torque
    if answer.status is SolutionStatus.FAILED:
        return answer
    if native.largest_excess(answer.torque, box.lower, box.upper) <= VIOLATION_TOLERANCE:
        return answer
    y = reduced_acceleration(reduced, answer.acceleration)
    factor = metric_factor(reduced, reduced.source.alpha, settings)
    about = forces.parametrization(reduced, y, factor, 1.0)._replace(force=answer.force)
    found = solve_qp(reduced, about, solver)
    return found._replace(
        progress=answer.progress,
        levels_dropped=answer.levels_dropped,
        of_candidates=answer.of_candidates,
        iterations=answer.iterations + found.iterations,
    )

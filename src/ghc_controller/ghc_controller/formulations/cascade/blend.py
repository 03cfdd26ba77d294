"""Blend of the answers of several orders: it meets every convex bound that they meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.ramp import PacedPriorities
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.types import Array


def blend(answers: Sequence[Solution], priorities: Priorities) -> Solution:
    """sum_c rho_c answer_c: convex bounds hold for it, and it is linear in the shares.

    The worst status counts. A ramp with a torque-rate budget chooses its shares here.
    """
    if len(answers) == 1 and not isinstance(priorities, PacedPriorities):
        return answers[0]
    shares, progress = _shares(answers, priorities)
    in_force = [answer for answer, share in zip(answers, shares, strict=True) if share > 0.0]
    failed = [answer for answer in in_force if answer.status is SolutionStatus.FAILED]
    if failed:
        return failed[0]
    if len(in_force) == 1:
        return in_force[0]._replace(progress=progress)
    weights = shares[shares > 0.0]
    largest = in_force[int(np.argmax(weights))]
    return largest._replace(
        acceleration=_mean(weights, [answer.acceleration for answer in in_force]),
        force=_mean(weights, [answer.force for answer in in_force]),
        torque=_mean(weights, [answer.torque for answer in in_force]),
        status=max((answer.status for answer in in_force), key=lambda status: status.value),
        qp_solved=any(answer.qp_solved for answer in in_force),
        violation=max(answer.violation for answer in in_force),
        primal_residual=max(answer.primal_residual for answer in in_force),
        dual_residual=max(answer.dual_residual for answer in in_force),
        iterations=sum(answer.iterations for answer in in_force),
        acceleration_slack=_largest([answer.acceleration_slack for answer in in_force]),
        rows_slack=_largest([answer.rows_slack for answer in in_force]),
        force_slack=_largest([answer.force_slack for answer in in_force]),
        levels_dropped=max(answer.levels_dropped for answer in in_force),
        rate_gave_way=any(answer.rate_gave_way for answer in in_force),
        progress=progress,
        of_candidates=(),
    )


def with_forces(
    blended: Solution, answers: Sequence[Solution], problem: ControlProblem
) -> Solution:
    """The blend with the forces of each answer, where each has its own cost on them."""
    if not problem.own_costs():
        return blended
    failed = any(answer.status is SolutionStatus.FAILED for answer in answers)
    return blended._replace(of_candidates=() if failed else tuple(one.force for one in answers))


def _shares(answers: Sequence[Solution], priorities: Priorities) -> tuple[Array, float]:
    if isinstance(priorities, PacedPriorities):
        progress = priorities.progress([answer.torque for answer in answers])
        return priorities.shares_at(progress), progress
    return np.array([candidate.share for candidate in priorities.candidates]), 0.0


def _mean(weights: Array, values: Sequence[Array]) -> Array:
    """Weighted sum of arrays (r,); entries that all share come out unchanged."""
    last = values[-1]
    result: Array = last.copy()
    for weight, value in zip(weights[:-1], values[:-1], strict=True):
        result += weight * (value - last)
    return result


def _largest(slacks: Sequence[Array | None]) -> Array | None:
    given = [slack for slack in slacks if slack is not None]
    return np.max(given, axis=0) if given else None

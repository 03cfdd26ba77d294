"""Hierarchical QP: one level after the other, each in the null space of those before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ghc_controller.formulations.bounded_qp import solve_bounded
from ghc_controller.formulations.formulation import Formulation, Solution, SolutionStatus
from ghc_controller.formulations.problem import ControlProblem
from ghc_controller.formulations.qp_rows import Parametrization
from ghc_controller.formulations.reduction import ReducedProblem, reduce_contacts
from ghc_controller.formulations.violation import largest_violation
from ghc_controller.hierarchy.directions import Starts
from ghc_controller.qp import VIOLATION_TOLERANCE
from ghc_controller.small_factors import inverse_factor
from ghc_controller.types import Array, Bounds

_KEEP_FEASIBLE = 2e-8  # [rad/s^2], [Nm] widening that keeps the answer of the level above


class Hqp(Formulation):
    """Cascade of damped least squares with all bounds at every level (baseline of the paper).

    Level l: min |J_l (x + Z u) - b_l|^2 + w |u|^2 subject to the bounds; then x += Z u and Z
    becomes the null space of J_l Z, with singular values below `rank_tolerance` of the largest
    taken as zero. It has no continuous priorities: alpha > 1/2 counts as "above", so that a
    ramp switches at its middle and a transition of duration 0 switches at once.
    """

    name = "hqp"

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced = reduce_contacts(problem)
        d = reduced.jacobian.shape[1]
        y, null = np.zeros(d), np.eye(d)
        answer: Solution | None = None
        worst = SolutionStatus.SOLVED
        for level in levels(problem.alpha):
            if null.shape[1] == 0:
                break
            rows, target = _stack(reduced, problem.starts, level)
            local = rows @ null
            hessian = local.T @ local + settings.regularization * np.eye(null.shape[1])
            factor = inverse_factor(hessian)
            best = factor @ (factor.T @ (local.T @ (target - rows @ y)))
            parametrization = Parametrization.whitened(
                y + null @ best, np.ascontiguousarray(null @ factor), problem.contacts
            )
            found = solve_bounded(reduced, parametrization, self.solver, settings)
            if answer is None and found.status is SolutionStatus.FAILED:
                return found
            if answer is not None and not _keeps_bounds(problem, worst, found):
                break  # no pivot left, or rounding: keep the answer of the level above
            worst = max(worst, found.status, key=lambda status: status.value)
            first = found if answer is None else answer
            answer = found._replace(
                qp_solved=found.qp_solved or (answer is not None and answer.qp_solved),
                acceleration_slack=first.acceleration_slack,
                rows_slack=first.rows_slack,
                force_slack=first.force_slack,
                rate_gave_way=first.rate_gave_way,
                reason=first.reason,
            )
            y = _reduced(reduced, found.acceleration)
            reduced = _keep_feasible(reduced, found)
            null = null @ _null_space(local, settings.rank_tolerance)
        if answer is None:
            raise ValueError("hqp needs at least one active task")
        return answer._replace(status=worst)


def levels(alpha: Array) -> list[list[int]]:
    """Active tasks by level, highest first: those dominated by equally many others share one."""
    active = [i for i in range(alpha.shape[0]) if alpha[i, i] <= 0.5]
    above = {i: sum(alpha[i, j] > 0.5 for j in active if j != i) for i in active}
    return [[i for i in active if above[i] == count] for count in sorted(set(above.values()))]


def _keeps_bounds(problem: ControlProblem, worst: SolutionStatus, found: Solution) -> bool:
    """Whether an answer below the first level is optimal, and SOLVED ones within all bounds.

    Each level may use the tolerance of the bounds anew: what counts are those of the problem.
    """
    if found.status is SolutionStatus.FAILED or found.reason:
        return False
    if worst is not SolutionStatus.SOLVED:
        return True
    answer = (found.acceleration, found.force, found.torque)
    return largest_violation(problem, *answer, problem.torque) <= VIOLATION_TOLERANCE


def _stack(reduced: ReducedProblem, starts: Starts, level: list[int]) -> tuple[Array, Array]:
    rows = np.concatenate([np.arange(starts[i], starts[i + 1]) for i in level])
    return reduced.jacobian[rows], reduced.target[rows]


def _reduced(reduced: ReducedProblem, x: Array) -> Array:
    if reduced.basis is None or reduced.offset is None:
        return x
    return reduced.basis.T @ (x - reduced.offset)


def _null_space(rows: Array, rank_tolerance: float) -> Array:
    _, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > rank_tolerance * max(float(sigma[0]), 1e-300)))
    return right[rank:].T


def _keep_feasible(reduced: ReducedProblem, found: Solution) -> ReducedProblem:
    """The same problem with bounds that contain the answer of the level above."""
    source = reduced.source
    widened = replace(
        source,
        acceleration=_containing(source.acceleration, found.acceleration),
        torque=_containing(source.torque, found.torque),
    )
    return reduced._replace(source=widened)


def _containing(bounds: Bounds, value: Array) -> Bounds:
    return Bounds(
        np.minimum(bounds.lower, value - _KEEP_FEASIBLE),
        np.maximum(bounds.upper, value + _KEEP_FEASIBLE),
    )

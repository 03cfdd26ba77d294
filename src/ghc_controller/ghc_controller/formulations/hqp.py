"""Hierarchical QP: one level after the other, each in the null space of those before."""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.formulations.best_answer import BestAnswer
from ghc_controller.formulations.cascade.force_center import balanced_contacts
from ghc_controller.formulations.cascade.level_answers import (
    UPPER_FORCE_WEIGHT,
    free_answer,
    keep_feasible,
    reduced_acceleration,
    rows_of,
)
from ghc_controller.formulations.formulation import Formulation
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.formulations.second_order import level_term
from ghc_controller.hierarchy.levels import levels
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.types import Array


@register_formulation
class Hqp(Formulation):
    """Cascade of damped least squares with all bounds at every level (baseline of the paper).

    Level l: min |J_l (x + Z u) - b_l|^2 + w |u|^2 subject to the bounds; then x += Z u and Z
    becomes the null space of J_l Z. What is chosen here:

    - Rank: singular values of J_l Z below `rank_tolerance` (1e-4) of the largest are zero.
    - Damping: w |u|^2 pulls accelerations to 0, as in the literature; with `hqp_damps_velocity`
      x starts at -kd v, which pulls them there as the other formulations do.
    - Contact forces follow the accelerations at least cost; their own cost belongs to the last
      level and counts UPPER_FORCE_WEIGHT^2 of that in those before.

    It has no continuous priorities: alpha > 1/2 counts as "above", so that a ramp switches at its
    middle and a transition of duration 0 switches at once.
    """

    name = "hqp"

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced, forces = balanced_contacts(problem)
        y, null = np.zeros(reduced.jacobian.shape[1]), np.eye(reduced.jacobian.shape[1])
        if settings.hqp_damps_velocity:
            y, _ = reduced.about_rest(settings.rest_damping)
        order = levels(problem.alpha) or [[]]  # without an active task a level of no row
        best = BestAnswer(problem, len(order))
        above = np.zeros(len(problem.target))  # 1 for rows of the levels before
        for depth, level in enumerate(order):
            is_last = depth + 1 == len(order)
            moves = null.shape[1] > 0 or best.is_empty
            if not (moves or (is_last and forces.free.shape[1])):
                continue  # no motion is left; the last level still chooses the forces
            index = rows_of(problem.starts, level)
            rows, target = reduced.jacobian[index], reduced.target[index]
            local = rows @ null
            hessian = local.T @ local + settings.regularization * np.eye(null.shape[1])
            right = local.T @ (target - rows @ y)
            if problem.second_order is not None:
                term = level_term(reduced, level, above, null @ null.T)
                hessian += null.T @ term.matrix @ null
                right -= null.T @ (term.pull + term.matrix @ y)
            above[index] = 1.0
            factor = native.inverse_factor(hessian)
            optimum = y + null @ (factor @ (factor.T @ right))
            below = null @ _null_space(local, settings.rank_tolerance)
            found = free_answer(reduced, forces, optimum)
            if found is None:
                weight = 1.0 if is_last else UPPER_FORCE_WEIGHT
                whitened = np.ascontiguousarray(null @ factor)
                parametrization = forces.parametrization(reduced, optimum, whitened, weight)
                found = solve_qp(reduced, parametrization, self.solver)
            if not best.accept(depth, found):
                break
            y = reduced_acceleration(reduced, found.acceleration)
            reduced, null = keep_feasible(reduced, found), below
        return best.answer


def _null_space(rows: Array, rank_tolerance: float) -> Array:
    if rows.size == 0:
        return np.eye(rows.shape[1])
    _, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > rank_tolerance * max(float(sigma[0]), 1e-300)))
    return right[rank:].T

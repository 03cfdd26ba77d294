"""Gradient-balanced GHC: one QP, the same priority matrix, and lexicographic accuracy."""

from __future__ import annotations

from ghc_controller.formulations.bounded_qp import solve_qp, unbounded_answer
from ghc_controller.formulations.formulation import Formulation, Solution
from ghc_controller.formulations.kernels import (
    balanced_target,
    weighted_system,
)
from ghc_controller.formulations.problem import ControlProblem
from ghc_controller.formulations.qp_rows import Parametrization
from ghc_controller.formulations.reduction import reduce_contacts
from ghc_controller.small_factors import inverse_factor

_GUARD = 0.02  # [-] of w: below it the target system is damped
_LARGEST_SPREAD = 1e10  # [-] of the metric between the first and the last level
_METRIC_FLOOR = 1e-4  # [-] weight of directions that no task claims


class BalancedGhc(Formulation):
    """Balance of projected gradients (design, section 3.2).

    [sum_i P_i J_i^T J_i + w I] x* = sum_i P_i J_i^T b_i is the damped lexicographic optimum at
    strict orders and linear in the P_i, hence continuous in alpha. The QP
    min 1/2 (x - x*)^T W (x - x*), W = sum_i gamma_i J_i^T J_i, decides what yields at bounds.
    """

    name = "balanced"

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced = reduce_contacts(problem)
        target, _ = balanced_target(
            reduced.jacobian,
            reduced.target,
            problem.starts,
            problem.alpha,
            settings.regularization,
            settings.projector.rank_tolerance,
            settings.projector.layer_damping,
            _GUARD * settings.regularization,
        )
        answer = unbounded_answer(reduced, target)
        if answer is not None:
            return answer
        k = problem.alpha.shape[0]
        ratio = min(settings.metric_ratio, _LARGEST_SPREAD ** (1.0 / max(k - 1, 1)))
        metric, _ = weighted_system(
            reduced.jacobian,
            reduced.target,
            problem.starts,
            problem.alpha,
            ratio,
            _METRIC_FLOOR,
        )
        factor = inverse_factor(metric)
        parametrization = Parametrization.whitened(target, factor, problem.contacts)
        return solve_qp(reduced, parametrization, self.solver, settings)

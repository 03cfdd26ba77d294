"""Weighting strategy: one QP whose task weights follow the priority matrix."""

from __future__ import annotations

from ghc_controller.core import native
from ghc_controller.formulations.formulation import Formulation
from ghc_controller.formulations.nearest_answer import LARGEST_WEIGHT
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.formulations.second_order import weighted_terms
from ghc_controller.problem.bounded_qp import solve_bounded
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.problem.solution import Solution


@register_formulation
class Weighted(Formulation):
    """Eq. 12 of the GHC paper with omega_i = (1 - alpha_ii) ratio^(s_i).

    s_i = sum_j alpha_ji counts the tasks that i dominates: continuous in alpha, never strict. With
    many tasks the ratio is less than weight_ratio, so that no weight exceeds 1e6.
    Damping is w |x + kd v|^2.
    """

    name = "weighted"

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced = reduce_contacts(problem)
        origin, target = reduced.about_rest(settings.rest_damping)
        hessian, right = native.weighted_system(
            reduced.jacobian,
            target,
            problem.starts,
            problem.alpha,
            settings.weight_ratio,
            LARGEST_WEIGHT,
            settings.regularization,
        )
        if problem.second_order is not None:
            weights = native.priority_weights(problem.alpha, settings.weight_ratio, LARGEST_WEIGHT)
            curved, pull = weighted_terms(reduced, weights, origin)
            hessian, right = hessian + curved, right - pull
        factor = native.inverse_factor(hessian)
        optimum = origin + factor @ (factor.T @ right)
        parametrization = Parametrization.whitened(optimum, factor, problem.contacts)
        return solve_bounded(reduced, parametrization, self.solver)

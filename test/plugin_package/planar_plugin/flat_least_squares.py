"""A formulation: least squares over all tasks at once, whatever their order."""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations import Formulation
from ghc_controller.numerics.small_factors import inverse_factor
from ghc_controller.problem.bounded_qp import solve_bounded
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.problem.solution import Solution


class FlatLeastSquares(Formulation):
    """min sum_i (1 - alpha_ii) |J_i x - b_i|^2 + w |x + kd v|^2 under all bounds."""

    name = "flat_least_squares"
    takes_second_order = False

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        reduced = reduce_contacts(problem)
        origin, target = reduced.about_rest(self.settings.velocity_damping)
        present = 1.0 - np.diag(problem.alpha)
        weighted = np.repeat(present, np.diff(problem.starts))[:, None] * reduced.jacobian
        hessian = weighted.T @ reduced.jacobian
        hessian += self.settings.regularization * np.eye(len(origin))
        factor = inverse_factor(hessian)
        optimum = origin + factor @ (factor.T @ (weighted.T @ target))
        parametrization = Parametrization.whitened(optimum, factor, problem.contacts)
        return solve_bounded(reduced, parametrization, self.solver)

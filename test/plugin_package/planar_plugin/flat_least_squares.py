"""A formulation: least squares over all tasks at once, whatever their order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.core import inverse_factor
from ghc_controller.formulations import Formulation, FormulationSettings
from ghc_controller.problem.bounded_qp import solve_bounded
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE


@dataclass(frozen=True, slots=True)
class FlatSettings:
    """What only this formulation has; set like any other setting, by these names."""

    last_share: float = declared(
        "weight of the last task, of that of the others", 1.0, unit="-", domain=POSITIVE
    )

    def __post_init__(self) -> None:
        check(self)


class FlatLeastSquares(Formulation):
    """min sum_i s_i (1 - alpha_ii) |J_i x - b_i|^2 + w |x + kd v|^2 under all bounds.

    s_i = last_share for the last task of the robot, else 1.
    """

    name = "flat_least_squares"
    takes_second_order = False
    own_settings = FlatSettings

    def __init__(self, settings: FormulationSettings, solver: QpSolver, own: FlatSettings) -> None:
        super().__init__(settings, solver)
        self.own = own

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        reduced = reduce_contacts(problem)
        origin, target = reduced.about_rest(self.settings.velocity_damping)
        present = 1.0 - np.diag(problem.alpha)
        present[-1] *= self.own.last_share
        weighted = np.repeat(present, np.diff(problem.starts))[:, None] * reduced.jacobian
        hessian = weighted.T @ reduced.jacobian
        hessian += self.settings.regularization * np.eye(len(origin))
        factor = inverse_factor(hessian)
        optimum = origin + factor @ (factor.T @ (weighted.T @ target))
        parametrization = Parametrization.whitened(optimum, factor, problem.contacts)
        return solve_bounded(reduced, parametrization, self.solver)

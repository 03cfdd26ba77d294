"""Generalized Hierarchical Control as eq. 13 is written: one variable nu'_i per task."""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations.formulation import Formulation, TorqueRegularization
from ghc_controller.formulations.ghc import NO_IDENTITIES, torque_reference
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.hierarchy.projector import generalized_projectors
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.problem.solution import Solution


@register_formulation
class FullGhc(Formulation):
    """Eq. 13 of the GHC paper over (nu'_1 .. nu'_k, f); tau follows from (13b).

    Reference for the condensed form in tests and benchmarks: k times the variables, same answer.
    As there x = -kd v + sum_i P_i nu'_i; velocity_damping = 0 is the paper's own QP.
    """

    name = "ghc_full"
    takes_second_order = False
    linear_because = NO_IDENTITIES

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced = reduce_contacts(problem)
        projectors = generalized_projectors(
            reduced.jacobian, problem.starts, problem.alpha, self.projector
        )
        origin, target = reduced.about_rest(settings.velocity_damping)
        k, d = projectors.shape[0], projectors.shape[1]
        contact_rows = reduced.torque_force.shape[1]
        size = k * d + contact_rows
        hessian = np.zeros((size, size))
        gradient = np.zeros(size)
        for i in range(k):
            rows = reduced.jacobian[problem.starts[i] : problem.starts[i + 1]]
            block = slice(i * d, (i + 1) * d)
            hessian[block, block] = rows.T @ rows + settings.regularization * np.eye(d)
            gradient[block] = -rows.T @ target[problem.starts[i] : problem.starts[i + 1]]
        acceleration_factor = np.zeros((d, size))
        acceleration_factor[:, : k * d] = np.hstack(list(projectors))
        force_factor, center = np.zeros((contact_rows, size)), np.zeros(contact_rows)
        if problem.contacts is not None:  # variables F^-1 (f - f_0)
            hessian[k * d :, k * d :] = np.eye(contact_rows)
            force_factor[:, k * d :] = problem.contacts.force_factor
            center = problem.contacts.force_center
        if settings.torque_regularization is not TorqueRegularization.NONE:
            tau_factor = (
                reduced.torque_matrix @ acceleration_factor + reduced.torque_force @ force_factor
            )
            offset = reduced.torque_offset + reduced.torque_force @ center
            offset = offset + reduced.torque_matrix @ origin - torque_reference(reduced, settings)
            hessian += settings.torque_weight * tau_factor.T @ tau_factor
            gradient += settings.torque_weight * tau_factor.T @ offset
        parametrization = Parametrization(origin, acceleration_factor, center, force_factor)
        return solve_qp(reduced, parametrization, self.solver, hessian, gradient)

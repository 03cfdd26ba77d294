"""Generalized Hierarchical Control in its condensed form: eq. 13 without the nu'_i, exactly."""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.formulations.formulation import (
    Formulation,
    FormulationSettings,
    Metric,
    TorqueRegularization,
)
from ghc_controller.formulations.metrics import metric_root
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.problem.bounded_qp import solve_bounded, solve_qp, unbounded_answer
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import ReducedProblem, reduce_contacts
from ghc_controller.problem.solution import Solution
from ghc_controller.types import Array

NO_IDENTITIES = (
    "its x = sum_i P_i nu_i minimizes |J_i nu_i - b_i|^2 + w |nu_i|^2, and the identities that "
    "condense it, such as J_i^T (J_i J_i^T + w I)^-1 b_i, do not hold with S_i"
)


@register_formulation
class CondensedGhc(Formulation):
    """Eq. 13 of the GHC paper with the task variables nu'_i minimized out.

    With x = sum_i P_i nu'_i fixed, the least cost of the nu'_i is w/2 (x - x0)^T G^-1 (x - x0).
    L L^T = G and x = x0 + L s leave 1/2 |s|^2 over n variables, and no QP where x0 is feasible.

    Accelerations are measured from -kd v: x = -kd v + sum_i P_i nu'_i, which damps one task by
    w |x + kd v|^2 and leaves motions that no task claims at x = -kd v. velocity_damping = 0, or
    v = 0, is the paper's own QP.

    With `metric` W other than I, nu'_i and projectors are those of z = W^1/2 x: P_i becomes
    W^-1/2 P_i(J W^-1/2) W^1/2. For W = M it is dynamically consistent: P_i M^-1 = M^-1 P_i^T, and
    torques of a task in M P_i M^-1 do not accelerate those above it.
    """

    name = "ghc"
    takes_second_order = False
    linear_because = NO_IDENTITIES

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced = reduce_contacts(problem)
        origin, target = reduced.about_rest(settings.velocity_damping)
        root = None
        rows = reduced.jacobian
        if settings.metric is not Metric.ACCELERATION:
            root = metric_root(reduced, settings.metric)
            rows = rows @ root
        moved, projectors = native.ghc_target(
            rows,
            target,
            problem.starts,
            problem.alpha,
            settings.regularization,
            self.projector.rank_tolerance,
            self.projector.layer_damping,
        )
        x0 = origin + (moved if root is None else root @ moved)
        unweighted = settings.torque_regularization is TorqueRegularization.NONE
        answer = unbounded_answer(reduced, x0) if unweighted else None
        if answer is not None:
            return answer
        factor = native.ghc_factor(
            rows,
            problem.starts,
            problem.alpha,
            projectors,
            settings.regularization,
            self.projector.layer_damping,
        )
        if root is not None:
            factor = root @ factor
        scale = float(np.sqrt(settings.regularization))
        parametrization = Parametrization.whitened(x0, factor, problem.contacts, scale)
        if unweighted:
            return solve_qp(reduced, parametrization, self.solver)
        weighted = _with_torque_cost(reduced, parametrization, settings)
        return solve_bounded(reduced, weighted, self.solver)


def torque_reference(reduced: ReducedProblem, settings: FormulationSettings) -> Array:
    """(a,) torque to which the weight on tau pulls: the bias h, or zero."""
    source = reduced.source
    if settings.torque_regularization is TorqueRegularization.BIAS:
        return source.bias[source.unactuated :]
    return np.zeros(source.bias.shape[0] - source.unactuated)


def _with_torque_cost(
    reduced: ReducedProblem, parametrization: Parametrization, settings: FormulationSettings
) -> Parametrization:
    """Whiten again with wt/(2 w) |tau - reference|^2 added to 1/2 |s|^2."""
    weight = settings.torque_weight / settings.regularization
    tau_factor = (
        reduced.torque_matrix @ parametrization.acceleration_factor
        + reduced.torque_force @ parametrization.force_factor
    )
    tau = (
        reduced.torque_offset
        + reduced.torque_matrix @ parametrization.acceleration
        + reduced.torque_force @ parametrization.force
    )
    hessian = np.eye(tau_factor.shape[1]) + weight * tau_factor.T @ tau_factor
    gradient = weight * tau_factor.T @ (tau - torque_reference(reduced, settings))
    lower = np.linalg.cholesky(hessian)
    rescale = np.linalg.solve(lower, np.eye(lower.shape[0])).T
    shift = -rescale @ (rescale.T @ gradient)
    return Parametrization(
        parametrization.acceleration + parametrization.acceleration_factor @ shift,
        np.ascontiguousarray(parametrization.acceleration_factor @ rescale),
        parametrization.force + parametrization.force_factor @ shift,
        np.ascontiguousarray(parametrization.force_factor @ rescale),
    )

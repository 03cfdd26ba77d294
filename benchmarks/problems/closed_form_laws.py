"""GHC without a QP: the projectors that section 4.1 of the paper reviews, and their laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

import ghc_controller as ghc
from ghc_controller.formulations import Metric
from ghc_controller.formulations.metrics import metric_matrix
from ghc_controller.hierarchy.projector import generalized_projectors
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.qp import make_solver
from ghc_controller.types import Array

# Jacobians of all tasks and the row of alpha of the projected task, (k,) -> (n, n)
Projector = Callable[[Sequence[Array], Array], Array]


def product_of_5(jacobians: Sequence[Array], alpha: Array) -> Array:
    """Eq. 5 for several tasks: product of I - alpha_ij J_j^+ J_j, highest alpha first."""
    n = jacobians[0].shape[1]
    result = np.eye(n)
    for j in np.argsort(-alpha, kind="stable"):
        result = result @ (np.eye(n) - alpha[j] * np.linalg.pinv(jacobians[j]) @ jacobians[j])
    return result


def stacked_6(jacobians: Sequence[Array], alpha: Array) -> Array:
    """Eq. 6 on the stacked rows: I - V Theta V^T, where theta_k belongs to a singular vector.

    Rows are stacked by falling alpha and theta_k is that of row k: it acts on whatever direction
    has the k-th singular value, which need not be of that row's task.
    """
    order = [j for j in np.argsort(-alpha, kind="stable") if alpha[j] > 0.0]
    n = jacobians[0].shape[1]
    if not order:
        return np.eye(n)
    theta = np.concatenate([np.full(len(jacobians[j]), alpha[j]) for j in order])
    _, sigma, right = np.linalg.svd(np.vstack([jacobians[j] for j in order]))
    kept = np.flatnonzero(sigma > 1e-9 * sigma[0])
    vectors = right[kept]
    return np.eye(n) - vectors.T @ (theta[kept, None] * vectors)


def naive_8(jacobians: Sequence[Array], alpha: Array) -> Array:
    """Eq. 8: I - sum over rows of alpha_ij J_j^T J_j / |J_j|^2."""
    result = np.eye(jacobians[0].shape[1])
    for jacobian, a in zip(jacobians, alpha, strict=True):
        for row in jacobian:
            result -= a * np.outer(row, row) / (row @ row)
    return result


def generalized_11(jacobians: Sequence[Array], alpha: Array) -> Array:
    """Eq. 11, algorithms 1 and 2."""
    sizes = [len(jacobian) for jacobian in jacobians]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    matrix = np.tile(alpha, (len(sizes), 1))
    return generalized_projectors(np.vstack(jacobians), starts, matrix)[0]


PROJECTORS: dict[str, Projector] = {
    "(5), product": product_of_5,
    "(6), stacked": stacked_6,
    "(8), sum over rows": naive_8,
    "(11), generalized": generalized_11,
}


class ClosedForm(ghc.Formulation):
    """x = -kd v + sum_i P_i nu_i without bounds, nu_i each task's own optimum.

    `static`: torques sum_i P_i J_i^T f_i instead, f_i the force that alone serves task i. P_i is
    then orthogonal to the rows J, so it keeps static forces of the tasks above and not their
    accelerations.
    """

    name = "closed_form"

    def __init__(
        self, projector: Projector, settings: ghc.FormulationSettings, static: bool = False
    ) -> None:
        super().__init__(settings, make_solver("daqp"))
        self._project, self._static = projector, static

    def solve(self, problem: ghc.ControlProblem) -> ghc.Solution:
        """See Formulation.solve; fixed base without contacts."""
        reduced = reduce_contacts(problem)
        origin, target = reduced.about_rest(self.settings.velocity_damping)
        rows = np.split(problem.jacobian, problem.starts[1:-1])
        wanted = np.split(target, problem.starts[1:-1])
        mass = metric_matrix(reduced, Metric.INERTIA if self._static else Metric.ACCELERATION)
        inverse = np.linalg.inv(mass)
        w = self.settings.regularization
        x = origin
        for i, (jacobian, b) in enumerate(zip(rows, wanted, strict=True)):
            alpha = problem.alpha[i].copy()
            gram = jacobian @ inverse @ jacobian.T + w * np.eye(len(b))
            own = jacobian.T @ np.linalg.solve(gram, b)
            x = x + inverse @ (self._project(rows, alpha) @ own)
        return ghc.Solution.unbounded(x, problem.mass_matrix @ x + problem.bias)

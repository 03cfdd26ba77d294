"""The operational space formulation with priorities (Khatib, Sentis and Park 2008)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.formulations.baselines.strict_law import Level, StrictLaw
from ghc_controller.formulations.formulation import Metric
from ghc_controller.formulations.metrics import metric_matrix
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.types import Array


@register_formulation
class OperationalSpace(StrictLaw):
    """A baseline of Jeong and Chang 2009; `task_priority` in the metric M without its bases Z_i.

    Torques J_i*^T F_i of each level, in the dynamically consistent null space of those above;
    `damped_levels` selects the task inertias that are damped.
    """

    name = "operational_space"

    def accelerations(self, order: Sequence[Level], reduced: ReducedProblem) -> Array:
        """See StrictLaw.accelerations."""
        mass = metric_matrix(reduced, Metric.INERTIA)  # the scale of M cancels where lambda = 0
        tolerance = self.projector.rank_tolerance
        return operational_space(order, mass, self.damping(len(order)), tolerance)


def operational_space(
    order: Sequence[Level], mass: Array, damping: Sequence[float], tolerance: float
) -> Array:
    """(d,) x = M^-1 sum_i J_i*^T F_i with J_i* = J_i N_i and F_i = Lambda_i (b_i - J_i x_(i-1)).

    Lambda_i = (J_i* M^-1 J_i*^T + lambda I)^+, N_(i+1) = N_i - M^-1 J_i*^T Lambda_i J_i* with the
    undamped Lambda_i, M (d, d).

    Args:
        damping: lambda of each level.
        tolerance: [-] of the largest eigenvalue of J_i M^-1 J_i^T; smaller ones of that of J_i*
            are zero.
    """
    d = len(mass)
    inverse = np.linalg.inv(mass)
    x, null = np.zeros(d), np.eye(d)
    for (jacobian, target), damped in zip(order, damping, strict=True):
        projected = jacobian @ null
        whole = jacobian @ inverse @ jacobian.T
        eigenvalues, vectors = np.linalg.eigh(projected @ inverse @ projected.T)
        kept = eigenvalues > tolerance * max(float(np.linalg.norm(whole, 2)), 1e-300)
        eigenvalues, vectors = eigenvalues[kept], vectors[:, kept]
        back = inverse @ projected.T @ vectors  # M^-1 J_i*^T in the axes of Lambda_i
        x = x + back @ ((vectors.T @ (target - jacobian @ x)) / (eigenvalues + damped))
        null = null - (back / eigenvalues) @ (vectors.T @ projected)
    return x

"""The unifying framework of Peters et al. (2008), as Jeong and Chang (2009) state it in eq. 40."""

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
class Unifying(StrictLaw):
    """A baseline of Jeong and Chang 2009 with an algorithmic error (34): only level 1 is met.

    Every level is answered as if it were alone, at least torque, and then projected. The product
    of projectors protects level 1 alone, so that level 3 disturbs level 2.
    """

    name = "unifying"

    def accelerations(self, order: Sequence[Level], reduced: ReducedProblem) -> Array:
        """See StrictLaw.accelerations."""
        square = metric_matrix(reduced, Metric.TORQUE)  # the scale of M^2 cancels where lambda = 0
        tolerance = self.projector.rank_tolerance
        return unifying(order, square, self.damping(len(order)), tolerance)


def unifying(
    order: Sequence[Level], square: Array, damping: Sequence[float], tolerance: float
) -> Array:
    """(d,) x = sum_i N_i J_i^{W+} b_i, N_(i+1) = N_i (I - J_i^{W+} J_i), W = M^2 (eq. 39, 40).

    J^{W+} = W^-1 J^T (J W^-1 J^T + lambda I)^+. C + G of (37) stands outside its brackets, as in
    (40); inside and outside, as printed, counts it twice.

    Args:
        square: (d, d) W.
        damping: lambda of each level.
        tolerance: [-] of the largest eigenvalue of J W^-1 J^T; smaller ones are zero.
    """
    d = len(square)
    inverse = np.linalg.inv(square)
    x, null = np.zeros(d), np.eye(d)
    for (jacobian, target), damped in zip(order, damping, strict=True):
        eigenvalues, vectors = np.linalg.eigh(jacobian @ inverse @ jacobian.T)
        kept = eigenvalues > tolerance * max(eigenvalues.max(initial=0.0), 1e-300)
        eigenvalues, vectors = eigenvalues[kept], vectors[:, kept]
        back = inverse @ jacobian.T @ vectors  # W^-1 J^T in the axes of the inverse
        weighted_inverse = (back / (eigenvalues + damped)) @ vectors.T
        x = x + null @ (weighted_inverse @ target)
        null = null - null @ weighted_inverse @ jacobian
    return x

"""Resolved acceleration (Siciliano and Slotine 1991), with and without the SR inverse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.formulations.baselines.strict_law import Level, StrictLaw
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.types import Array


@register_formulation
class ResolvedAcceleration(StrictLaw):
    """Eq. 28 of Jeong and Chang 2009: their first baseline.

    `damped_levels` none is the pseudo-inverse, the others the singularity-robust (SR) inverse of
    their levels. Null spaces are undamped in both.
    """

    name = "resolved_acceleration"

    def accelerations(
        self,
        order: Sequence[Level],
        reduced: ReducedProblem,  # noqa: ARG002
    ) -> Array:
        """See StrictLaw.accelerations."""
        tolerance = self.projector.rank_tolerance
        return resolved_acceleration(order, self.damping(len(order)), tolerance)


def resolved_acceleration(
    order: Sequence[Level], damping: Sequence[float], tolerance: float
) -> Array:
    """(d,) x = sum_i (J_i N_i)^+ (b_i - J_i x_(i-1)), N_(i+1) = N_i - (J_i N_i)^+ J_i N_i.

    Args:
        damping: of the SR inverse A^T (A A^T + lambda I)^-1 of each level; 0 = pseudo-inverse.
        tolerance: [-] of the largest singular value of J_i; smaller ones of J_i N_i are zero.
    """
    d = order[0].jacobian.shape[1]
    x, null = np.zeros(d), np.eye(d)
    for (jacobian, target), damped in zip(order, damping, strict=True):
        projected = jacobian @ null
        left, sigma, right = np.linalg.svd(projected, full_matrices=False)
        kept = sigma > tolerance * max(float(np.linalg.norm(jacobian, 2)), 1e-300)
        left, sigma, right = left[:, kept], sigma[kept], right[kept]
        x = x + right.T @ (sigma / (sigma**2 + damped) * (left.T @ (target - jacobian @ x)))
        null = null - right.T @ right
    return x

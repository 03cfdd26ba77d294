"""The optimal task-priority framework of Jeong and Chang (2009), without its extended Jacobian."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ghc_controller.formulations.baselines.strict_law import Level, StrictLaw
from ghc_controller.formulations.formulation import Metric
from ghc_controller.formulations.metrics import metric_root
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.types import Array


@register_formulation
class TaskPriority(StrictLaw):
    """Eq. 15 to 18 and 27: each task as near as those above it allow, by least squares.

    `metric` chooses what is least among the accelerations that do: |x|^2 as in the paper, x^T M x
    (which is operational space) or the torque |M x|^2. `damped_levels` chooses between (18), (27)
    as printed and (27) with level 1 damped as well, with lambda = w.
    """

    name = "task_priority"

    def accelerations(self, order: Sequence[Level], reduced: ReducedProblem) -> Array:
        """See StrictLaw.accelerations."""
        damping, tolerance = self.damping(len(order)), self.projector.rank_tolerance
        if self.settings.metric is Metric.ACCELERATION:
            return task_priority(order, damping, tolerance)
        root = metric_root(reduced, self.settings.metric)
        scaled = [Level(level.jacobian @ root, level.target) for level in order]
        return root @ task_priority(scaled, damping, tolerance)


def task_priority(order: Sequence[Level], damping: Sequence[float], tolerance: float) -> Array:
    """(d,) x = J_E^+ h_E of (18), or of (27) where a level's damping lambda is not 0.

    The rows of Z_i are an orthonormal basis of the row space of J_i N_i, r_i of them as (12)
    counts. In the basis [Z_1; Z_2; ..] the extended Jacobian (15) is block lower triangular, since
    J_i Z_j^T = 0 for j > i; so its blocks are solved one after the other:
        C_i = J_i Z_i^T,  (C_i^T C_i + lambda I) y_i = C_i^T (b_i - J_i x),  x += Z_i^T y_i.
    The pseudo-inverse of (18) would square the condition of J_i N_i; here nothing does while
    lambda = 0.

    Args:
        damping: lambda of each level [J^2].
        tolerance: [-] of a row's norm; what is left of it counts as a direction.
    """
    d = order[0].jacobian.shape[1]
    x, used = np.zeros(d), np.zeros((0, d))
    for (jacobian, target), damped in zip(order, damping, strict=True):
        basis = new_directions(jacobian, used, tolerance)
        block = jacobian @ basis.T
        missing = target - jacobian @ x
        if damped > 0.0:
            gram = block.T @ block + damped * np.eye(len(basis))
            y = np.linalg.solve(gram, block.T @ missing)
        else:
            y = np.linalg.lstsq(block, missing, rcond=0.0)[0]
        x = x + basis.T @ y
        used = np.vstack([used, basis])
    return x


def new_directions(jacobian: Array, used: Array, tolerance: float) -> Array:
    """(r_i, d) Z_i: what rows (m_i, d) add to orthonormal rows `used` (r, d), by Gram-Schmidt.

    Two passes: after one, a direction at an angle of 1e-7 to those above is wrong by 1e-3.
    """
    basis, rank, d = used, len(used), jacobian.shape[1]
    for row in jacobian:
        if len(basis) == d:
            break
        direction = row
        for _ in range(2):
            direction = direction - basis.T @ (basis @ direction)
        length = float(np.linalg.norm(direction))
        if length > tolerance * float(np.linalg.norm(row)):
            basis = np.vstack([basis, direction / length])
    return basis[rank:]

"""Norms in which accelerations are made least: |x|^2, x^T M x or |M x|^2."""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations.formulation import Metric
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.types import Array

_FLOOR = 1e-9  # [-] of a metric's mean: keeps it regular where it loses a direction


def metric_matrix(reduced: ReducedProblem, metric: Metric) -> Array:
    """(d, d) W of the norm x^T W x: I, M or M^2, scaled to trace d.

    Without the scale w would mean something else in each metric. In contact M is that of the
    motions that keep it, and M^2 that of the joint torques without contact forces.
    """
    d = reduced.jacobian.shape[1]
    if metric is Metric.ACCELERATION:
        return np.eye(d)
    if metric is Metric.TORQUE:
        matrix = reduced.torque_matrix.T @ reduced.torque_matrix
    else:
        mass, basis = reduced.source.mass_matrix, reduced.basis
        matrix = mass if basis is None else basis.T @ mass @ basis
    scale = d / max(float(np.trace(matrix)), 1e-300)  # contacts may leave no motion: d = 0
    return matrix * scale + _FLOOR * np.eye(d)


def metric_root(reduced: ReducedProblem, metric: Metric) -> Array:
    """(d, d) R = L^-T with W = L L^T: x = R z has x^T W x = |z|^2, and rows J x = (J R) z."""
    lower = np.linalg.cholesky(metric_matrix(reduced, metric))
    return np.ascontiguousarray(np.linalg.solve(lower, np.eye(lower.shape[0])).T)

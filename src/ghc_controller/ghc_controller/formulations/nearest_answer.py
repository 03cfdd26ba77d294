"""The bounded answer nearest to wanted accelerations, in a metric graded by the priorities."""

from __future__ import annotations

from ghc_controller.formulations.bounded_qp import solve_qp, unbounded_answer
from ghc_controller.formulations.formulation import FormulationSettings, Solution
from ghc_controller.formulations.qp_rows import Parametrization
from ghc_controller.formulations.reduction import ReducedProblem
from ghc_controller.formulations.weight_kernels import weighted_system
from ghc_controller.qp import QpSolver
from ghc_controller.small_factors import inverse_factor
from ghc_controller.types import Array

_LARGEST_WEIGHT = 1e6  # [-] of the metric, between the first level and the last
_METRIC_FLOOR = 1.0  # [-] weight on |x|^2: that of the last level, so that it adds no spread


def nearest_answer(
    reduced: ReducedProblem,
    wanted: Array,
    alpha: Array,
    settings: FormulationSettings,
    solver: QpSolver,
) -> Solution:
    """Answer of accelerations `wanted` (d,) where they meet every bound; else the nearest one.

    Nearest: min 1/2 (x - wanted)^T W (x - wanted), W = sum_i gamma_i J_i^T J_i + I, whose weights
    gamma_i fall by `metric_ratio` from one level of alpha (k, k) to the next.
    """
    answer = unbounded_answer(reduced, wanted)
    if answer is not None:
        return answer
    metric, _ = weighted_system(
        reduced.jacobian,
        reduced.target,
        reduced.source.starts,
        alpha,
        settings.metric_ratio,
        _LARGEST_WEIGHT,
        _METRIC_FLOOR,
    )
    factor = inverse_factor(metric)
    parametrization = Parametrization.whitened(wanted, factor, reduced.source.contacts)
    return solve_qp(reduced, parametrization, solver)

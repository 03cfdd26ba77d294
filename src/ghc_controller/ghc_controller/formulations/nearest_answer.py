"""The bounded answer nearest to wanted accelerations, in a metric graded by the priorities."""

from __future__ import annotations

from ghc_controller.core import native
from ghc_controller.formulations.formulation import FormulationSettings
from ghc_controller.problem.bounded_qp import solve_qp, unbounded_answer
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array

LARGEST_WEIGHT = 1e6  # [-] between the first level and the last; ratio^s is 1e18 for ten tasks
_METRIC_FLOOR = 1.0  # [-] weight on |x|^2: that of the last level, so that it adds no spread


def nearest_answer(
    reduced: ReducedProblem,
    wanted: Array,
    alpha: Array,
    settings: FormulationSettings,
    solver: QpSolver,
) -> Solution:
    """Answer of accelerations `wanted` (d,) where they meet every bound; else the nearest one.

    Nearest: min 1/2 (x - wanted)^T W (x - wanted), W as in `metric_factor`.
    """
    answer = unbounded_answer(reduced, wanted)
    if answer is not None:
        return answer
    factor = metric_factor(reduced, alpha, settings)
    parametrization = Parametrization.whitened(wanted, factor, reduced.source.contacts)
    return solve_qp(reduced, parametrization, solver)


def metric_factor(reduced: ReducedProblem, alpha: Array, settings: FormulationSettings) -> Array:
    """(d, d) F with F F^T = W^-1, W = sum_i gamma_i J_i^T J_i + I.

    The weights gamma_i fall by `metric_ratio` from one level of alpha (k, k) to the next.
    """
    metric, _ = native.weighted_system(
        reduced.jacobian,
        reduced.target,
        reduced.source.starts,
        alpha,
        settings.metric_ratio,
        LARGEST_WEIGHT,
        _METRIC_FLOOR,
    )
    return native.inverse_factor(metric)

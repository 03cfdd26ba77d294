"""The dual active-set method of `dual_active_set` as a solver."""

from __future__ import annotations

from ghc_controller.qp.dual_active_set import INFEASIBLE, LIMIT, SOLVED, solve_dual
from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.solver import QpSolver

_STATUS = {
    SOLVED: QpStatus.SOLVED,
    INFEASIBLE: QpStatus.INFEASIBLE,
    LIMIT: QpStatus.ITERATION_LIMIT,
}


class DualSolver(QpSolver):
    """Exact up to rounding, from any start the same, right about conflicts (README, "Solvers")."""

    name = "dual"

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """See QpSolver.run."""
        ended, pivots, x, y, z = solve_dual(*problem, limit)
        return QpResult(x, y, z, _STATUS.get(ended, QpStatus.FAILED), pivots)

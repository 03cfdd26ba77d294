"""The dual active-set method of `dual_active_set` as a solver."""

from __future__ import annotations

import numpy as np

from ghc_controller.qp.dual_active_set import INFEASIBLE, LIMIT, SOLVED, solve_dual
from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.solver import QpSolver, SolverSettings

_STATUS = {
    SOLVED: QpStatus.SOLVED,
    INFEASIBLE: QpStatus.INFEASIBLE,
    LIMIT: QpStatus.ITERATION_LIMIT,
}


class DualSolver(QpSolver):
    """Exact up to rounding, from any start the same, right about conflicts (README, "Solvers")."""

    name = "dual"

    def __init__(self, settings: SolverSettings) -> None:
        """Load the compiled code too: it is needed when something is wrong, and then at once."""
        super().__init__(settings)
        none, one = np.zeros(0), np.ones(1)
        row = np.ones((1, 1))
        self.run(QpProblem(row, one, np.zeros((0, 1)), none, row, one, one), 1)

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """See QpSolver.run."""
        ended, pivots, x, y, z = solve_dual(*map(np.ascontiguousarray, problem), limit)
        return QpResult(x, y, z, _STATUS.get(ended, QpStatus.FAILED), pivots)

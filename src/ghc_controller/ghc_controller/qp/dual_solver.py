"""The dual active-set method of the core (`core/qp/dual_method.hpp`) as a solver."""

from __future__ import annotations

from ghc_controller.core import native
from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.solver import QpSolver

_STATUS = (QpStatus.SOLVED, QpStatus.INFEASIBLE, QpStatus.ITERATION_LIMIT, QpStatus.FAILED)


class DualSolver(QpSolver):
    """Exact up to rounding, from any start the same, right about conflicts (README, "Solvers")."""

    name = "dual"

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """See QpSolver.run."""
        ended, pivots, x, y, z = native.solve_dual(*problem, limit)
        return QpResult(x, y, z, _STATUS[ended], pivots)

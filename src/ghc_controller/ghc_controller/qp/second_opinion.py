"""A solver that is asked first, and another one for answers that do not hold up."""

from __future__ import annotations

from ghc_controller.qp.problem import RESIDUAL_TOLERANCE, QpProblem, QpResult, QpStatus, residuals
from ghc_controller.qp.solver import QpSolver


class SecondOpinion(QpSolver):
    """`first` unless its answer misses the KKT conditions; a conflict it reports is believed."""

    def __init__(self, first: QpSolver, second: QpSolver) -> None:
        self.name = first.name
        self._first = first
        self._second = second
        self.asked = 0  # how often the second one was needed

    def solve(self, problem: QpProblem) -> QpResult:
        """See QpSolver.solve."""
        result = self._first.solve(problem)
        if result.status is QpStatus.INFEASIBLE:
            return result
        if result.found and residuals(problem, result).relative(result) <= RESIDUAL_TOLERANCE:
            return result
        self.asked += 1
        return self._second.solve(problem)

"""A solver that is asked first, and another one for answers that do not hold up."""

from __future__ import annotations

from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.residuals import Residuals, residuals
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
        return self.solve_checked(problem)[0]

    def solve_checked(self, problem: QpProblem) -> tuple[QpResult, Residuals]:
        """See QpSolver.solve_checked."""
        result = self._first.solve(problem)
        check = residuals(problem, result)
        if result.status is QpStatus.INFEASIBLE or (result.found and check.small):
            return result, check
        self.asked += 1
        return self._second.solve_checked(problem)

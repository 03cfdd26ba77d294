"""Primary solver with an exact second one for every answer that is not proven."""

from __future__ import annotations

from ghc_controller.qp.problem import QpProblem, QpResult
from ghc_controller.qp.residuals import Residuals, residuals
from ghc_controller.qp.solver import QpSolver, SolverSettings
from ghc_controller.types import Array


class Fallback(QpSolver):
    """`first` where its answer meets the KKT conditions, else `second`.

    A conflict, an iteration limit or a failure that `first` reports is no proof either: `second`
    solves the problem again. Each of the two has the pivots of a QP, both share those of a step.
    """

    def __init__(self, first: QpSolver, second: QpSolver, settings: SolverSettings) -> None:
        super().__init__(settings)
        self.name = first.name
        self._first = first
        self._second = second

    def reset(self) -> None:
        """See QpSolver.reset."""
        self._first.reset()
        self._second.reset()

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """See QpSolver.run: the primary solver alone."""
        return self._first.run(problem, limit)

    def _solve_checked(
        self, problem: QpProblem, units: Array | None
    ) -> tuple[QpResult, Residuals]:
        result = self.limited(problem, self._first)
        check = residuals(problem, result, units)
        if (result.found and check.small) or result.reason:
            return result, check
        self.counts["second_solver"] += 1
        again = self.limited(problem, self._second)
        return again, residuals(problem, again, units)

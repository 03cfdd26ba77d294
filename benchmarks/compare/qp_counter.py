"""QPs, pivots and operations of a solver, counted where every formulation solves its QPs."""

from __future__ import annotations

from typing import Any

import ghc_controller as ghc
from ghc_controller.qp.problem import QpProblem


class QpCounter:
    """Counts the QPs of a formulation from now on; `take` gives what came since the last one.

    Operations of a QP with n variables and r rows, a product with its sum as one: Cholesky
    factor and inverse of the Hessian 2 n^3 / 3, rows in its metric r n^2, and for each pivot the
    values of all rows r n and the update of the active set 3 n^2 (Goldfarb and Idnani, 1983).
    """

    def __init__(self, formulation: ghc.Formulation) -> None:
        self.qps, self.pivots, self.operations = 0, 0, 0.0
        self._solve = formulation.solver.solve_checked
        formulation.solver.solve_checked = self._counted  # type: ignore

    def take(self) -> tuple[int, int, float]:
        """QPs, pivots and operations since the last call."""
        found = self.qps, self.pivots, self.operations
        self.qps, self.pivots, self.operations = 0, 0, 0.0
        return found

    def _counted(self, problem: QpProblem, *others: Any) -> Any:
        answer = self._solve(problem, *others)
        pivots = max(int(answer[0].iterations), 0)
        n, rows = len(problem.g), len(problem.l) + len(problem.b)
        self.qps += 1
        self.pivots += pivots
        self.operations += 2.0 * n**3 / 3.0 + rows * n**2 + pivots * (rows * n + 3.0 * n**2)
        return answer

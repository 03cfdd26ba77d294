"""Counts QPs, pivots and operations of the solver used by all formulations."""

from __future__ import annotations

from typing import Any

import ghc_controller as ghc
from ghc_controller.qp.problem import QpProblem


class QpCounter:
    """Counts the QPs of a controller from now on; `take` gives what came since the last one.

    Operations of a QP with n variables and r rows, a product with its sum as one: Cholesky
    factor and inverse of the Hessian 2 n^3 / 3, rows in its metric r n^2, and for each pivot the
    values of all rows r n and the update of the active set 3 n^2 (Goldfarb and Idnani, 1983).
    QPs of the compiled core have the factor of their level, which is counted with it, and form
    rows where they become active: r n + 3 n^2 for each pivot, and once more for a QP, with n
    accelerations and all rows of the control problem. A step in one call of the core has no rows
    but the bounds on accelerations and torques.
    """

    def __init__(self, controller: ghc.Controller) -> None:
        self.qps, self.pivots, self.operations = 0, 0, 0.0
        formulation, model = controller.formulation, controller.model
        solver = formulation.solver
        self._alone = self._variables, self._rows = model.nv, model.nv + model.na
        self._solve, self._spend = solver.solve_checked, solver.spend
        self._account, self._answer = solver.account, formulation.solve
        solver.solve_checked = self._counted  # type: ignore
        solver.spend = self._spent  # type: ignore
        solver.account = self._accounted  # type: ignore
        formulation.solve = self._sized  # type: ignore
        self._finish = getattr(formulation, "finish", None)  # of those with such a step
        if self._finish is not None:
            formulation.finish = self._finished  # type: ignore

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

    def _sized(self, problem: ghc.ControlProblem) -> ghc.Solution:
        """Solve, with the sizes of what the core may count."""
        self._size(problem)
        return self._answer(problem)

    def _finished(self, problem: ghc.ControlProblem, *found: Any) -> ghc.Solution:
        """Finish what a step in one call left open, likewise."""
        assert self._finish is not None
        self._size(problem)
        return self._finish(problem, *found)

    def _size(self, problem: ghc.ControlProblem) -> None:
        general = 0 if problem.rows is None else len(problem.rows.lower)
        forces = 0 if problem.contacts is None else len(problem.contacts.force_lower)
        self._variables = len(problem.bias)
        self._rows = self._variables + len(problem.torque.lower) + general + forces

    def _spent(self, pivots: int, qps: int) -> None:
        """QPs of the core come here alone, with their number; those of solvers with none."""
        self._add(pivots, qps)
        self._spend(pivots, qps)

    def _accounted(self, pivots: int, qps: int) -> None:
        """The same of a step in one call."""
        self._variables, self._rows = self._alone
        self._add(pivots, qps)
        self._account(pivots, qps)

    def _add(self, pivots: int, qps: int) -> None:
        n, rows = self._variables, self._rows
        if qps:
            self.qps += qps
            self.pivots += pivots
            self.operations += (pivots + qps) * (rows * n + 3.0 * n**2)

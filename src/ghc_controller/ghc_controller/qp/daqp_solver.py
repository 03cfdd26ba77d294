"""DAQP: dual active-set solver, exact up to rounding and quick to see a conflict."""

from __future__ import annotations

import daqp
import numpy as np

from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.solver import QpSolver, SolverSettings
from ghc_controller.types import Array

_EQUALITY = 5
_OPTIMAL = 1
_STATUS = {1: QpStatus.SOLVED, 2: QpStatus.SOLVED, -1: QpStatus.INFEASIBLE}
_STATUS[-4] = QpStatus.ITERATION_LIMIT
_MANY_ACTIVE = 10  # rows; from here on a start from the last active set is worth its overhead


class DaqpSolver(QpSolver):
    """Feed it whitened problems: with eigenvalues of H near 1e-6 its answers are wrong.

    After an answer with many active rows the next problem of the same size starts from them. The
    answer is exact from any start: only the time and the last digits depend on it.
    """

    name = "daqp"

    def __init__(self, settings: SolverSettings) -> None:
        super().__init__(settings)
        self._multipliers: dict[tuple[int, int, int], Array] = {}  # by size of the problem

    def reset(self) -> None:
        """See QpSolver.reset."""
        self._multipliers.clear()

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """See QpSolver.run."""
        equalities = problem.b.shape[0]
        if equalities:
            rows = np.vstack([problem.A, problem.C])
            lower = np.concatenate([problem.b, problem.l])
            upper = np.concatenate([problem.b, problem.u])
        else:
            rows, lower, upper = problem.C, problem.l.copy(), problem.u.copy()
        sense = np.zeros(lower.shape[0], dtype=np.int32)
        sense[:equalities] = _EQUALITY
        size = (problem.g.shape[0], equalities, lower.shape[0])
        x, _, flag, info = daqp.solve(
            problem.H,
            problem.g,
            np.ascontiguousarray(rows),
            upper,
            lower,
            sense,
            primal_tol=self.settings.tolerance,
            iter_limit=limit,
            dual_start=self._multipliers.pop(size, None),
        )
        multipliers = np.asarray(info["lam"])
        if flag == _OPTIMAL and np.count_nonzero(multipliers) > _MANY_ACTIVE:
            self._multipliers[size] = multipliers
        return QpResult(
            np.asarray(x),
            multipliers[:equalities].copy(),
            multipliers[equalities:].copy(),
            _STATUS.get(flag, QpStatus.FAILED),
            int(info["iterations"]),
        )

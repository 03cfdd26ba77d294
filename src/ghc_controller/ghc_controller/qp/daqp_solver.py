"""DAQP: dual active-set solver, exact up to rounding and quick to see a conflict."""

from __future__ import annotations

import daqp
import numpy as np

from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.solver import QpSolver, SolverSettings

_EQUALITY = 5
_STATUS = {1: QpStatus.SOLVED, 2: QpStatus.SOLVED, -1: QpStatus.INFEASIBLE}
_STATUS[-4] = QpStatus.ITERATION_LIMIT
_PIVOTS_PER_ITERATION = 20


class DaqpSolver(QpSolver):
    """Feed it whitened problems: with eigenvalues of H near 1e-6 its answers are wrong."""

    name = "daqp"

    def __init__(self, settings: SolverSettings) -> None:
        self._settings = settings

    def solve(self, problem: QpProblem) -> QpResult:
        """See QpSolver.solve."""
        equalities = problem.b.shape[0]
        if equalities:
            rows = np.vstack([problem.A, problem.C])
            lower = np.concatenate([problem.b, problem.l])
            upper = np.concatenate([problem.b, problem.u])
        else:
            rows, lower, upper = problem.C, problem.l.copy(), problem.u.copy()
        sense = np.zeros(lower.shape[0], dtype=np.int32)
        sense[:equalities] = _EQUALITY
        x, _, flag, info = daqp.solve(
            problem.H,
            problem.g,
            np.ascontiguousarray(rows),
            upper,
            lower,
            sense,
            primal_tol=self._settings.tolerance,
            iter_limit=self._settings.max_iterations * _PIVOTS_PER_ITERATION,
        )
        multipliers = np.asarray(info["lam"])
        return QpResult(
            np.asarray(x),
            multipliers[:equalities].copy(),
            multipliers[equalities:].copy(),
            _STATUS.get(flag, QpStatus.FAILED),
            int(info["iterations"]),
        )

"""Fallback solver for generators if their structured solve fails."""

from __future__ import annotations

import numpy as np

from ghc_controller.qp import RESIDUAL_TOLERANCE, QpProblem, SolverSettings, make_solver, residuals
from ghc_controller.types import Array

_MAX_PIVOTS = 4000  # a preview has hundreds of rows


class SecondSolver:
    """Solves a dense QP; accepts a solution only if it meets the optimality conditions."""

    def __init__(self) -> None:
        self._solver = make_solver("daqp", SolverSettings(max_pivots=_MAX_PIVOTS))
        self.asked = 0

    def solve(self, problem: QpProblem) -> Array | None:
        """The optimum; None if no solution passes the check."""
        self.asked += 1
        result = self._solver.solve(problem)
        if not result.found:
            return None
        check = residuals(problem, result)
        size = 1.0 + float(np.abs(result.x).max())
        return result.x if max(check.primal, check.dual) <= RESIDUAL_TOLERANCE * size else None

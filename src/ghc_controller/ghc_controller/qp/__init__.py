"""Quadratic programs: the problem, its solution, and the solvers behind one interface."""

from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.residuals import (
    RESIDUAL_TOLERANCE,
    VIOLATION_TOLERANCE,
    Residuals,
    residuals,
)
from ghc_controller.qp.solver import QpSolver, SolverSettings
from ghc_controller.qp.solvers import SOLVERS, make_solver, register_solver

__all__ = [
    "RESIDUAL_TOLERANCE",
    "SOLVERS",
    "VIOLATION_TOLERANCE",
    "QpProblem",
    "QpResult",
    "QpSolver",
    "QpStatus",
    "Residuals",
    "SolverSettings",
    "make_solver",
    "register_solver",
    "residuals",
]

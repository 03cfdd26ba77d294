"""Quadratic programs: the problem, its solution, and the solvers behind one interface."""

from .problem import QpProblem, QpResult, QpStatus, Residuals, residuals
from .solver import SOLVERS, QpSolver, SolverSettings, make_solver

__all__ = [
    "SOLVERS",
    "QpProblem",
    "QpResult",
    "QpSolver",
    "QpStatus",
    "Residuals",
    "SolverSettings",
    "make_solver",
    "residuals",
]

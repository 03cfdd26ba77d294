"""The choice between QP solvers."""

from __future__ import annotations

from collections.abc import Callable

from ghc_controller.errors import UnknownName
from ghc_controller.qp.daqp_solver import DaqpSolver
from ghc_controller.qp.dual_solver import DualSolver
from ghc_controller.qp.fallback import Fallback
from ghc_controller.qp.proxqp_solver import ProxqpSolver
from ghc_controller.qp.solver import QpSolver, SolverSettings


def _proxqp(settings: SolverSettings) -> QpSolver:
    return ProxqpSolver(settings)


def _daqp(settings: SolverSettings) -> QpSolver:
    solver = Fallback(DaqpSolver(settings), DualSolver(settings), settings)
    solver.lets_core_solve = True
    return solver


# daqp comes first: on the whitened problems of this stack it takes a tenth of ProxQP's time, is
# exact up to rounding, and sees a conflict at once (README, "Solvers").
SOLVERS: dict[str, Callable[[SolverSettings], QpSolver]] = {"daqp": _daqp, "proxqp": _proxqp}


def make_solver(name: str, settings: SolverSettings | None = None) -> QpSolver:
    """Solver of that name.

    Raises:
        UnknownName: no such solver; the message lists those that exist.
    """
    if name not in SOLVERS:
        raise UnknownName("QP solver", name, SOLVERS)
    return SOLVERS[name](settings or SolverSettings())

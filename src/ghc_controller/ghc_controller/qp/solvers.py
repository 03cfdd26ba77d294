"""The choice between QP solvers."""

from __future__ import annotations

from collections.abc import Callable

from ghc_controller.qp.daqp_solver import DaqpSolver
from ghc_controller.qp.dual_solver import DualSolver
from ghc_controller.qp.fallback import Fallback
from ghc_controller.qp.proxqp_solver import ProxqpSolver
from ghc_controller.qp.solver import QpSolver, SolverSettings
from ghc_controller.registry import Registry

SolverFactory = Callable[[SolverSettings], QpSolver]  # a class, or a function

SOLVERS: Registry[SolverFactory] = Registry("QP solver", "ghc_controller.solvers")
register_solver = SOLVERS.register


@register_solver("proxqp")
def _proxqp(settings: SolverSettings) -> QpSolver:
    return ProxqpSolver(settings)


# daqp comes first: on the whitened problems of this stack it takes a tenth of ProxQP's time, is
# exact up to rounding, and sees a conflict at once (README, "Solvers").
@register_solver("daqp")
def _daqp(settings: SolverSettings) -> QpSolver:
    solver = Fallback(DaqpSolver(settings), DualSolver(settings), settings)
    solver.lets_core_solve = True
    return solver


def make_solver(name: str, settings: SolverSettings | None = None) -> QpSolver:
    """Solver of that name.

    Raises:
        UnknownName: no such solver; the message lists those that exist.
        PluginError: a package brings it and it cannot be loaded.
    """
    return SOLVERS[name](settings or SolverSettings())

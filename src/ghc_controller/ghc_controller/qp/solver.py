"""The interface of a QP solver and the choice between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

from ghc_controller.errors import UnknownName
from ghc_controller.qp.problem import QpProblem, QpResult
from ghc_controller.qp.residuals import Residuals, residuals


@dataclass(frozen=True, slots=True)
class SolverSettings:
    """Tolerance and effort of a solve, the same words for every solver."""

    tolerance: float = 1e-9  # largest primal and dual residual, in the QP's own scale
    max_iterations: int = 200  # proxqp: outer iterations; daqp: 20 times as many pivots


class QpSolver(ABC):
    """Solves one QP after the other; sizes may change between calls."""

    name: str

    @abstractmethod
    def solve(self, problem: QpProblem) -> QpResult:
        """Solve; never raises for a problem without solution, `status` says so."""

    def solve_checked(self, problem: QpProblem) -> tuple[QpResult, Residuals]:
        """Solve, with the residuals of the answer."""
        result = self.solve(problem)
        return result, residuals(problem, result)


def _proxqp(settings: SolverSettings) -> QpSolver:
    from ghc_controller.qp.proxqp_solver import ProxqpSolver

    return ProxqpSolver(settings)


def _daqp(settings: SolverSettings) -> QpSolver:
    from ghc_controller.qp.daqp_solver import DaqpSolver
    from ghc_controller.qp.second_opinion import SecondOpinion

    return SecondOpinion(DaqpSolver(settings), _proxqp(settings))


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

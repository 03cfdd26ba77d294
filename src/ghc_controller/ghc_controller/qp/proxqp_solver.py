"""ProxQP (proxsuite), dense backend: one workspace per problem size, updated per solve."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

from proxsuite import proxqp

from ghc_controller.qp.problem import QpProblem, QpResult, QpStatus
from ghc_controller.qp.solver import QpSolver, SolverSettings

_STATUS = {
    proxqp.QPSolverOutput.PROXQP_SOLVED: QpStatus.SOLVED,
    proxqp.QPSolverOutput.PROXQP_MAX_ITER_REACHED: QpStatus.ITERATION_LIMIT,
    proxqp.QPSolverOutput.PROXQP_PRIMAL_INFEASIBLE: QpStatus.INFEASIBLE,
    proxqp.QPSolverOutput.PROXQP_DUAL_INFEASIBLE: QpStatus.FAILED,
}
_INNER = 10  # inner iterations per outer one: more rescue no problem, they only take time
_DUALITY_GAP = (
    1e-7  # of the cost; without it multipliers of rows that are not active are let through
)
_MAX_WORKSPACES = 8  # sizes kept; nominal, relaxed and one per level of a cascade


class ProxqpSolver(QpSolver):
    """Augmented-Lagrangian solver, started from the previous answer of the same size.

    Its penalties start afresh: carried over, they make the next problem miss the iteration limit.
    """

    name = "proxqp"

    def __init__(self, settings: SolverSettings) -> None:
        super().__init__(settings)
        self._workspaces: OrderedDict[tuple[int, int, int], Any] = OrderedDict()

    @property
    def pivots_per_qp(self) -> int:
        """See QpSolver.pivots_per_qp: inner iterations."""
        return self.settings.max_iterations * _INNER

    def reset(self) -> None:
        """See QpSolver.reset."""
        self._workspaces.clear()

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        """See QpSolver.run."""
        sizes = (problem.g.shape[0], problem.b.shape[0], problem.l.shape[0])
        workspace = self._workspaces.get(sizes)
        if workspace is None:
            workspace = self._new_workspace(sizes)
            workspace.init(
                problem.H, problem.g, problem.A, problem.b, problem.C, problem.l, problem.u
            )
        else:
            workspace.update(
                H=problem.H,
                g=problem.g,
                A=problem.A,
                b=problem.b,
                C=problem.C,
                l=problem.l,
                u=problem.u,
                update_preconditioner=True,
            )
        workspace.settings.max_iter = max(limit // _INNER, 1)
        workspace.solve()
        results = workspace.results
        status = _STATUS.get(results.info.status, QpStatus.FAILED)
        answer = QpResult(
            results.x.copy(), results.y.copy(), results.z.copy(), status, results.info.iter
        )
        if status is not QpStatus.SOLVED:
            del self._workspaces[sizes]  # multipliers of a conflict spoil the next warm start
        return answer

    def _new_workspace(self, sizes: tuple[int, int, int]) -> Any:
        workspace = proxqp.dense.QP(*sizes)
        settings = workspace.settings
        settings.eps_abs = self.settings.tolerance
        settings.eps_rel = 0.0
        settings.check_duality_gap = True
        settings.eps_duality_gap_abs = _DUALITY_GAP
        settings.eps_duality_gap_rel = 0.0
        settings.max_iter_in = _INNER
        # The defaults report false infeasibility where force bounds are small.
        settings.eps_primal_inf = 1e-14
        settings.eps_dual_inf = 1e-14
        settings.initial_guess = proxqp.InitialGuess.COLD_START_WITH_PREVIOUS_RESULT
        self._workspaces[sizes] = workspace
        if len(self._workspaces) > _MAX_WORKSPACES:
            self._workspaces.popitem(last=False)
        return workspace

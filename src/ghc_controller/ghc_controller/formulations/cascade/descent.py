"""The levels of one order that the compiled core leaves open: the rare path."""

from __future__ import annotations

import numpy as np

from ghc_controller.core import NullSpace, level_optimum, native
from ghc_controller.formulations.best_answer import BestAnswer
from ghc_controller.formulations.cascade.force_center import ForceCenter
from ghc_controller.formulations.cascade.level_answers import (
    UPPER_FORCE_WEIGHT,
    free_answer,
    keep_feasible,
    reduced_acceleration,
)
from ghc_controller.formulations.cascade.order import Order
from ghc_controller.formulations.formulation import FormulationSettings
from ghc_controller.formulations.second_order import level_term
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array


class Descent:
    """One pass through levels whose bounds conflict, that the core could not finish, or that have
    (x + kd v)^T S (x + kd v) beside their rows.
    """

    def __init__(
        self,
        settings: FormulationSettings,
        solver: QpSolver,
        reduced: ReducedProblem,
        forces: ForceCenter,
        order: Order,
    ) -> None:
        self.settings, self.solver = settings, solver
        self.reduced, self.forces, self.given = reduced, forces, reduced.source
        self.order = order
        brake = -settings.rest_damping * reduced.source.velocity
        self.y = brake if reduced.basis is None else reduced.basis.T @ brake

    def answer(self, first: int = 0, above: Solution | None = None) -> Solution:
        """Answer of the levels from `first` on, below the answer of those above.

        That of the last level that has one, where a later level fails.
        """
        settings, order = self.settings, self.order
        if above is not None:
            self._go_below(above)
        jacobian = self.reduced.jacobian[order.rows]
        target = self.reduced.target[order.rows]
        begins = [0, *order.ends[:-1]]
        parts = [slice(begin, end) for begin, end in zip(begins, order.ends, strict=True)]
        best = BestAnswer(self.given, len(parts))
        if above is not None:
            best.accept(first - 1, above)
        space = NullSpace(jacobian.shape[1], len(jacobian))
        met = np.zeros(len(self.given.target))  # 1 for rows of the levels before
        for part in parts[:first]:
            space.append(jacobian[part], settings.null_damping)
            met[order.rows[part]] = 1.0
        for level in range(first, len(parts)):
            if level and self.solver.is_late:
                best.leave_out(level)
                break
            part = parts[level]
            optimum, factor = self._optimum(jacobian[part], target[part], level, space, met)
            space.append(jacobian[part], settings.null_damping)
            met[order.rows[part]] = 1.0
            found = free_answer(self.reduced, self.forces, optimum)
            if found is None:
                weight = 1.0 if level + 1 == len(parts) else UPPER_FORCE_WEIGHT
                about = self.forces.parametrization(self.reduced, optimum, factor, weight)
                found = solve_qp(self.reduced, about, self.solver)
            if not best.accept(level, found):
                break
            self._go_below(found)
        return best.answer

    def _go_below(self, found: Solution) -> None:
        self.y = reduced_acceleration(self.reduced, found.acceleration)
        if found.qp_solved:
            self.reduced = keep_feasible(self.reduced, found)

    def _optimum(
        self, rows: Array, target: Array, level: int, space: NullSpace, met: Array
    ) -> tuple[Array, Array]:
        """Optimum c (d,) of a level and P F (d, d): accelerations c + P F s cost 1/2 |s|^2."""
        optimum, local, damping = level_optimum(
            rows, target, self.y, space, self.settings.regularization
        )
        P = space.projector()
        hessian = local.T @ local + damping * np.eye(len(self.y))
        if self.given.second_order is None:
            return optimum, P @ native.inverse_factor(hessian)
        term = level_term(self.reduced, self.order.tasks[level], met, P)
        factor = native.inverse_factor(hessian + term.matrix)
        right = (target - rows @ self.y) @ local
        right -= P @ (term.pull + term.matrix @ self.y)
        return self.y + P @ (factor @ (factor.T @ right)), P @ factor

"""The smooth cascade with blended orders: exact levels under bounds, torques linear in a ramp."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ghc_controller.core import Cascade as Core
from ghc_controller.core import NullSpace, level_optimum
from ghc_controller.formulations.balanced import BalancedGhc
from ghc_controller.formulations.best_answer import BestAnswer
from ghc_controller.formulations.cascade.blend import blend
from ghc_controller.formulations.cascade.core_terms import core_terms
from ghc_controller.formulations.cascade.force_center import ForceCenter, balanced_contacts
from ghc_controller.formulations.cascade.level_answers import (
    UPPER_FORCE_WEIGHT,
    free_answer,
    keep_feasible,
    reduced_acceleration,
    rows_of,
)
from ghc_controller.formulations.cascade.torque_rate import within_rate, without_rate
from ghc_controller.formulations.formulation import Formulation, FormulationSettings
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.formulations.second_order import level_term
from ghc_controller.hierarchy.directions import Starts
from ghc_controller.hierarchy.levels import is_order, levels
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.numerics.small_factors import inverse_factor
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem, reduce_contacts
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array

_ORDERS_KEPT = 64


@register_formulation
class Cascade(Formulation):
    """Levels one after the other, each in the smooth null space P of those above.

    Level l: min |J_l (y + P u) - b_l|^2 + w_l |u|^2 subject to every bound, from y = -kd v on.
    Where its optimum without bounds meets them all no QP is solved. Forces are centered on what
    the accelerations of the level need. Each candidate of a mixture of orders is answered by
    itself and the answers are blended; a matrix that is no order is answered by `balanced`. The
    torque rate limit is met once, by the blend (`torque_rate`).
    """

    name = "cascade"
    blends = True

    def __init__(self, settings: FormulationSettings, solver: QpSolver) -> None:
        super().__init__(settings, solver)
        self._orders: dict[tuple[bytes, bytes], Order | None] = {}

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        limited = problem.limits_rate
        free = without_rate(problem) if limited else problem
        contact_free, forces = balanced_contacts(reduce_contacts(free))
        candidates, answers = problem.priorities.candidates, []
        for index, candidate in enumerate(candidates):
            # None takes the pivots of another, or those of the torque rate limit.
            self.solver.begin_part(len(candidates) - index + limited)
            answers.append(self._answer(contact_free, forces, candidate.alpha))
        answer = blend(answers, problem.priorities)
        if not limited:
            return answer
        self.solver.begin_part(1)
        within = contact_free._replace(source=problem)
        return within_rate(within, forces, answer, self.settings, self.solver)

    def reset(self) -> None:
        """See Formulation.reset."""
        super().reset()
        for order in self._orders.values():
            if order is not None:
                order.core.forget()

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:
        """Orders always have an answer; a target that is none must have one by `balanced`."""
        general = BalancedGhc(self.settings, self.solver).solvability(jacobian, starts)
        return general._replace(along_ramp=False)

    def _answer(self, reduced: ReducedProblem, forces: ForceCenter, alpha: Array) -> Solution:
        order = self._order(alpha, reduced.source.starts)
        if order is not None:
            return _Descent(self.settings, self.solver, reduced, forces, order).answer()
        alone = replace(reduced.source, priorities=Priorities.of(alpha))
        return BalancedGhc(self.settings, self.solver).solve(alone)

    def _order(self, alpha: Array, starts: Starts) -> Order | None:
        """Order that the matrix says, None where it is none; remembered, since few are in use."""
        key = (alpha.tobytes(), starts.tobytes())
        if key not in self._orders:
            if len(self._orders) >= _ORDERS_KEPT:
                self._orders.clear()
            self._orders[key] = Order.of(alpha, starts) if is_order(alpha) else None
        return self._orders[key]


class Order(NamedTuple):
    """Rows of the tasks in the order of their levels, and the core's workspace for them."""

    rows: Starts  # (m,) indices into the augmented Jacobian
    ends: Starts  # (l,) end of each level among them
    tasks: tuple[tuple[int, ...], ...]  # of each level
    core: Core

    @classmethod
    def of(cls, alpha: Array, starts: Starts) -> Order:
        """Order of a matrix (k, k); without an active task one level that has no row."""
        tasks = tuple(tuple(level) for level in levels(alpha) or [[]])
        parts = [rows_of(starts, level) for level in tasks]
        rows, ends = np.concatenate(parts), np.cumsum([len(part) for part in parts])
        return cls(rows, ends, tasks, Core(rows.tolist(), ends.tolist()))


class _Descent:
    """One pass from the first level to the last: the compiled core, and what it leaves open."""

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
        brake = -settings.velocity_damping * reduced.source.velocity
        self.y = brake if reduced.basis is None else reduced.basis.T @ brake

    def answer(self) -> Solution:
        """Answer of the last level; of the last one that has one, where a later level fails."""
        if self.given.second_order is not None:
            return self._from(0, None)
        settings, solver = self.settings, self.solver
        answered, pivots, qps, violation, x, torque, force = self.order.core.solve(
            self.reduced.jacobian,
            self.reduced.target,
            self.y,
            *core_terms(self.reduced, self.forces),
            settings.regularization,
            settings.null_damping,
            solver.lets_core_solve,
            solver.pivots_per_qp,
            solver.pivots_left,
        )
        solver.spend(pivots, qps)
        if not answered:
            return self._from(0, None)
        found = Solution(
            x,
            force,
            torque,
            SolutionStatus.SOLVED,
            qps > 0,
            primal_residual=violation,
            violation=violation,
            iterations=pivots,
        )
        if answered == len(self.order.ends):
            return found
        self._go_below(found)
        return self._from(answered, found)

    def _go_below(self, found: Solution) -> None:
        self.y = reduced_acceleration(self.reduced, found.acceleration)
        if found.qp_solved:
            self.reduced = keep_feasible(self.reduced, found)

    def _from(self, first: int, above: Solution | None) -> Solution:
        """Answer of the levels from `first` on, below the answer of those above.

        The rare path: levels whose bounds conflict, that the core could not finish, or that have
        (x + kd v)^T S (x + kd v) beside their rows.
        """
        settings, order = self.settings, self.order
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
            return optimum, P @ inverse_factor(hessian)
        term = level_term(self.reduced, self.order.tasks[level], met, P)
        factor = inverse_factor(hessian + term.matrix)
        right = (target - rows @ self.y) @ local
        right -= P @ (term.pull + term.matrix @ self.y)
        return self.y + P @ (factor @ (factor.T @ right)), P @ factor

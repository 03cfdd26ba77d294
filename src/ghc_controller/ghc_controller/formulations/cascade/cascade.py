"""The smooth cascade with blended orders: exact levels under bounds, torques linear in a ramp."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ghc_controller.formulations.balanced import BalancedGhc
from ghc_controller.formulations.cascade.blend import blend
from ghc_controller.formulations.cascade.force_center import ForceCenter, balanced_contacts
from ghc_controller.formulations.cascade.kernels import (
    Balance,
    Motion,
    Rows,
    free_levels,
    level_optimum,
)
from ghc_controller.formulations.cascade.level_answers import (
    UPPER_FORCE_WEIGHT,
    free_answer,
    keep_feasible,
    keeps_bounds,
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
from ghc_controller.hierarchy.soft_null_space import append_rows, null_projector
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.numerics.small_factors import inverse_factor
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem, reduce_contacts
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array

_EMPTY = np.zeros((0, 0))
_NONE = np.zeros(0)
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
    """Rows of the tasks in the order of their levels."""

    rows: Starts  # (m,) indices into the augmented Jacobian
    ends: Starts  # (l,) end of each level among them
    tasks: tuple[tuple[int, ...], ...]  # of each level

    @classmethod
    def of(cls, alpha: Array, starts: Starts) -> Order:
        """Order of a matrix (k, k); without an active task one level that has no row."""
        tasks = tuple(tuple(level) for level in levels(alpha) or [[]])
        parts = [rows_of(starts, level) for level in tasks]
        return cls(np.concatenate(parts), np.cumsum([len(part) for part in parts]), tasks)


class _Descent:
    """One pass from the first level to the last."""

    def __init__(
        self,
        settings: FormulationSettings,
        solver: QpSolver,
        reduced: ReducedProblem,
        forces: ForceCenter,
        order: Order,
    ) -> None:
        self.settings, self.solver = settings, solver
        self.w, self.e = settings.regularization, settings.null_damping
        self.reduced, self.forces, self.given = reduced, forces, reduced.source
        self.jacobian, self.target = reduced.jacobian[order.rows], reduced.target[order.rows]
        self.rows, self.ends, self.tasks = order
        self.basis, self.used = np.empty((len(order.rows) + 1, reduced.jacobian.shape[1])), 0
        brake = -settings.velocity_damping * reduced.source.velocity
        self.y = brake if reduced.basis is None else reduced.basis.T @ brake

    def answer(self) -> Solution:
        """Answer of the last level; of the last one that has one, where a later level fails."""
        best: Solution | None = None
        level, count = 0, len(self.ends)
        if self.given.second_order is not None:
            return self._answer_with_second_order()
        while level < count:
            free, self.used, self.y, x, tau, force = free_levels(
                self.jacobian,
                self.target,
                self.ends,
                level,
                self.y,
                self.basis,
                self.used,
                self.w,
                self.e,
                *_kernel_terms(self.reduced, self.forces),
            )
            if free > level:
                best = _after(best, Solution.unbounded(x, tau, force))
            if free == count:
                break
            found = self._bounded_level(free)
            if best is None and found.status is SolutionStatus.FAILED:
                return found
            if best is not None and not keeps_bounds(self.given, best.status, found):
                return best._replace(levels_dropped=count - free)
            best = _after(best, found)
            self.y = reduced_acceleration(self.reduced, found.acceleration)
            self.reduced = keep_feasible(self.reduced, found)
            level = free + 1
        assert best is not None
        return best

    def _answer_with_second_order(self) -> Solution:
        """As `answer`, with (x + kd v)^T S (x + kd v) in every level."""
        best: Solution | None = None
        above = np.zeros(len(self.given.target))
        for level, tasks in enumerate(self.tasks):
            part = slice(self.ends[level - 1] if level else 0, self.ends[level])
            rows, P = self.jacobian[part], null_projector(self.basis, self.used)
            _, local, damping = level_optimum(
                rows, self.target[part], self.y, self.basis, self.used, self.w
            )
            term = level_term(self.reduced, tasks, above, P)
            factor = inverse_factor(local.T @ local + damping * np.eye(len(self.y)) + term.matrix)
            right = (self.target[part] - rows @ self.y) @ local
            right -= P @ (term.pull + term.matrix @ self.y)
            optimum = self.y + P @ (factor @ (factor.T @ right))
            self.used = append_rows(rows, self.e, self.basis, self.used)
            above[self.rows[part]] = 1.0
            found = free_answer(self.reduced, self.forces, optimum)
            if found is None:
                weight = 1.0 if level + 1 == len(self.ends) else UPPER_FORCE_WEIGHT
                parametrization = self.forces.parametrization(
                    self.reduced, optimum, P @ factor, weight
                )
                found = solve_qp(self.reduced, parametrization, self.solver)
            if best is None and found.status is SolutionStatus.FAILED:
                return found
            if best is not None and not keeps_bounds(self.given, best.status, found):
                return best._replace(levels_dropped=len(self.tasks) - level)
            best = _after(best, found)
            self.y = reduced_acceleration(self.reduced, found.acceleration)
            if found.qp_solved:
                self.reduced = keep_feasible(self.reduced, found)
        assert best is not None
        return best

    def _bounded_level(self, level: int) -> Solution:
        """Answer of a level whose optimum is beyond a bound."""
        part = slice(self.ends[level - 1] if level else 0, self.ends[level])
        rows = self.jacobian[part]
        best, local, damping = level_optimum(
            rows, self.target[part], self.y, self.basis, self.used, self.w
        )
        factor = null_projector(self.basis, self.used) @ inverse_factor(
            local.T @ local + damping * np.eye(best.shape[0])
        )
        weight = 1.0 if level + 1 == len(self.ends) else UPPER_FORCE_WEIGHT
        parametrization = self.forces.parametrization(self.reduced, best, factor, weight)
        self.used = append_rows(rows, self.e, self.basis, self.used)
        return solve_qp(self.reduced, parametrization, self.solver)


def _kernel_terms(reduced: ReducedProblem, forces: ForceCenter) -> tuple[Motion, Balance, Rows]:
    """What `free_levels` takes of the problem."""
    source, contacts, general = reduced.source, reduced.source.contacts, reduced.source.rows
    acceleration, torque = source.acceleration, source.torque
    lower, upper = [acceleration.lower, torque.lower], [acceleration.upper, torque.upper]
    if general is not None:
        lower.append(general.lower)
        upper.append(general.upper)
    if contacts is not None:
        lower.append(contacts.force_lower)
        upper.append(contacts.force_upper)
    motion = (
        _EMPTY if reduced.basis is None else reduced.basis,
        _NONE if reduced.offset is None else reduced.offset,
        reduced.torque_matrix,
        reduced.torque_offset,
        reduced.torque_force,
    )
    balance = (
        forces.center,
        forces.gain,
        forces.residual,
        reduced.balance_matrix,
        reduced.balance_force,
    )
    rows = (
        _EMPTY if general is None else general.matrix,
        _EMPTY if contacts is None else contacts.force_matrix,
        np.concatenate(lower),
        np.concatenate(upper),
    )
    return motion, balance, rows


def _after(above: Solution | None, found: Solution) -> Solution:
    """The answer of a level below `above`: what gave way is what the first level gave."""
    if above is None:
        return found
    return found._replace(
        status=max(above.status, found.status, key=lambda status: status.value),
        qp_solved=above.qp_solved or found.qp_solved,
        iterations=above.iterations + found.iterations,
        acceleration_slack=above.acceleration_slack,
        rows_slack=above.rows_slack,
        force_slack=above.force_slack,
        rate_gave_way=above.rate_gave_way,
        reason=above.reason,
    )

"""The smooth cascade with blended orders: exact levels under bounds, torques linear in a ramp."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ghc_controller.formulations.balanced import BalancedGhc
from ghc_controller.formulations.blend import blend
from ghc_controller.formulations.bounded_qp import bounded_answer, solve_qp
from ghc_controller.formulations.cascade_kernels import level_damping, level_optimum
from ghc_controller.formulations.force_center import ForceCenter, balanced_contacts
from ghc_controller.formulations.formulation import Formulation, Solution, SolutionStatus
from ghc_controller.formulations.level_answers import (
    keep_feasible,
    reduced_acceleration,
    rows_of,
)
from ghc_controller.formulations.problem import ControlProblem
from ghc_controller.formulations.reduction import ReducedProblem, reduce_contacts
from ghc_controller.hierarchy.directions import Starts
from ghc_controller.hierarchy.levels import is_order, levels
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.soft_null_space import append_rows, null_projector
from ghc_controller.small_factors import inverse_factor
from ghc_controller.types import Array

_NO_ROWS = np.zeros(0, dtype=np.int64)
_UPPER_FORCE_WEIGHT = 1e-4  # [-] root of the weight on forces above the last level


class Cascade(Formulation):
    """Levels one after the other, each in the smooth null space P of those above.

    Level l: min |J_l (y + P u) - b_l|^2 + w_l |u|^2 subject to every bound, from y = -kd v on.
    Where its optimum without bounds meets them all no QP is solved. Forces are centered on what
    the accelerations of the level need. Each candidate of a mixture of orders is answered by
    itself and the answers are blended; a matrix that is no order is answered by `balanced`.
    """

    name = "cascade"
    blends = True

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        contact_free, forces = balanced_contacts(reduce_contacts(problem))
        answers = [
            self._answer(contact_free, forces, candidate.alpha)
            for candidate in problem.priorities.candidates
        ]
        return blend(answers, problem.priorities)

    def _answer(self, reduced: ReducedProblem, forces: ForceCenter, alpha: Array) -> Solution:
        if is_order(alpha):
            order = [rows_of(reduced.source.starts, level) for level in levels(alpha)]
            return _Descent(self, reduced, forces, order).answer()
        alone = replace(reduced.source, priorities=Priorities.of(alpha))
        return BalancedGhc(self.settings, self.solver).solve(alone)


class _Descent:
    """One pass from the first level to the last."""

    def __init__(
        self,
        cascade: Cascade,
        reduced: ReducedProblem,
        forces: ForceCenter,
        order: Sequence[Starts],
    ) -> None:
        order = order or [_NO_ROWS]
        settings = cascade.settings
        self.settings, self.solver = settings, cascade.solver
        self.w, self.e = settings.regularization, settings.null_damping
        self.reduced, self.forces = reduced, forces
        rows = np.concatenate(order)
        self.jacobian = np.ascontiguousarray(reduced.jacobian[rows])
        self.target = reduced.target[rows]
        self.ends = np.cumsum([len(level) for level in order]).astype(np.int64)
        d = reduced.jacobian.shape[1]
        self.basis, self.used = np.empty((len(rows) + 1, d)), 0
        brake = -settings.velocity_damping * reduced.source.velocity
        self.y = brake.copy() if reduced.basis is None else reduced.basis.T @ brake

    def answer(self) -> Solution:
        """Answer of the last level; of the last one that has one, where a later level fails."""
        best: Solution | None = None
        level = 0
        while level < len(self.ends):
            part = slice(self.ends[level - 1] if level else 0, self.ends[level])
            rows = self.jacobian[part]
            found = self._level(rows, self.target[part], level + 1 == len(self.ends))
            if found.status is SolutionStatus.FAILED:
                return found if best is None else best
            best = found if best is None else _after(best, found)
            self.y = reduced_acceleration(self.reduced, found.acceleration)
            if found.qp_solved:
                self.reduced = keep_feasible(self.reduced, found)
            self.used = append_rows(rows, self.e, self.basis, self.used)
            level += 1
        assert best is not None
        return best

    def _level(self, rows: Array, target: Array, is_last: bool) -> Solution:
        best, local, damping = level_optimum(rows, target, self.y, self.basis, self.used, self.w)
        force, balanced = self.forces.at(self.reduced, best)
        if balanced:
            answer = bounded_answer(self.reduced, best, force)
            if answer is not None:
                return answer
        d = best.shape[0]
        factor = null_projector(self.basis, self.used) @ inverse_factor(
            local.T @ local + damping * np.eye(d)
        )
        weight = 1.0 if is_last else _UPPER_FORCE_WEIGHT
        parametrization = self.forces.parametrization(self.reduced, best, factor, weight)
        return solve_qp(self.reduced, parametrization, self.solver, self.settings)


def _after(above: Solution, found: Solution) -> Solution:
    """The answer of a level below `above`: what gave way is what the first level gave."""
    return found._replace(
        status=max(above.status, found.status, key=lambda status: status.value),
        qp_solved=above.qp_solved or found.qp_solved,
        iterations=above.iterations + found.iterations,
        acceleration_slack=above.acceleration_slack,
        rows_slack=above.rows_slack,
        force_slack=above.force_slack,
        rate_gave_way=above.rate_gave_way,
    )

"""What the closed laws for strict orders share: levels, damping, bounds, and what they reject."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

from ghc_controller.formulations.cascade.level_answers import rows_of
from ghc_controller.formulations.formulation import DampedLevels, Formulation
from ghc_controller.formulations.nearest_answer import nearest_answer
from ghc_controller.hierarchy.levels import levels
from ghc_controller.hierarchy.orders_only import orders_only
from ghc_controller.hierarchy.priorities import Priorities
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem, reduce_contacts
from ghc_controller.problem.solution import Solution
from ghc_controller.types import Array, Starts


class Level(NamedTuple):
    """Rows of the tasks that share one level: J_i x should be b_i."""

    jacobian: Array  # (m_i, d) J_i
    target: Array  # (m_i,) b_i, the paper's h_i


class StrictLaw(Formulation):
    """Accelerations in closed form from levels 1 > 2 > .. > k, then the nearest bounded answer.

    A law handles one order at a time. During a ramp that is the accepted target of the largest
    share, so that priorities switch at its middle; a target that is no order is rejected.
    Accelerations are measured from -kd v, like those of the other formulations; velocity_damping
    = 0 is the form of the papers. A QP is solved only where they exceed a bound.
    """

    takes_second_order = False

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        reduced = reduce_contacts(problem)
        origin, target = reduced.about_rest(self.settings.velocity_damping)
        alpha = order_in_force(problem.priorities)
        order = levels_of(reduced.jacobian, target, problem.starts, alpha)
        moves = order and len(origin)  # contacts may leave no motion
        wanted = origin + self.accelerations(order, reduced) if moves else origin
        return nearest_answer(reduced, wanted, alpha, self.settings, self.solver)

    @abstractmethod
    def accelerations(self, order: Sequence[Level], reduced: ReducedProblem) -> Array:
        """(d,) accelerations without bounds; `order` has the highest level first, at least one."""

    def damping(self, count: int) -> list[float]:
        """w of each of `count` levels, 0 where a level is not damped."""
        w, which = self.settings.regularization, self.settings.damped_levels
        below = 0.0 if which is DampedLevels.NONE else w
        return [w if which is DampedLevels.ALL else 0.0, *([below] * (count - 1))]

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:  # noqa: ARG002
        """Every order has an answer; a matrix that is none is rejected."""
        return orders_only(self.name)


def order_in_force(priorities: Priorities) -> Array:
    """(k, k) accepted target of the largest share; of two alike the later one."""
    return max(reversed(priorities.candidates), key=lambda candidate: candidate.share).alpha


def levels_of(jacobian: Array, target: Array, starts: Starts, alpha: Array) -> list[Level]:
    """Rows by level, highest first; alpha (k, k) > 1/2 counts as above.

    Args:
        jacobian: (m, d). target: (m,). starts: (k + 1,) first row of each task.
    """
    indices = [rows_of(starts, tasks) for tasks in levels(alpha)]
    return [Level(jacobian[index], target[index]) for index in indices]

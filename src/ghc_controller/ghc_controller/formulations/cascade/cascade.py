"""The smooth cascade with blended orders: exact levels under bounds, torques linear in a ramp."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ghc_controller.core import Cascade as Core
from ghc_controller.core import Mixture
from ghc_controller.formulations.balanced import BalancedGhc
from ghc_controller.formulations.cascade.blend import blend, with_forces
from ghc_controller.formulations.cascade.descent import Descent
from ghc_controller.formulations.cascade.force_center import of_arrays
from ghc_controller.formulations.cascade.order import Order, Orders
from ghc_controller.formulations.cascade.torque_rate import within_rate, without_rate
from ghc_controller.formulations.formulation import Formulation, FormulationSettings
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.hierarchy.ramp import PacedPriorities
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array, Starts


@register_formulation
class Cascade(Formulation):
    """Levels one after the other, each in the smooth null space P of those above.

    Level l: min |J_l (y + P u) - b_l|^2 + w_l |u|^2 subject to every bound, from y = -kd v on.
    Where its optimum without bounds meets them all no QP is solved. Forces are centered on what
    the accelerations of the level need. Each candidate of a mixture of orders is answered by
    itself and the answers are blended; a matrix that is no order is answered by `balanced`. The
    torque rate limit is met once, by the blend (`torque_rate`).

    One call of the compiled core answers a tick (`core/hierarchy/mixture.hpp`). What it leaves
    open, a level whose bounds conflict or a torque outside the rate limit, is finished here.
    """

    name = "cascade"
    blends = True

    def __init__(self, settings: FormulationSettings, solver: QpSolver) -> None:
        super().__init__(settings, solver)
        self._orders = Orders()
        self.core = Mixture(settings.regularization, settings.null_damping, settings.rest_damping)

    def retune(self, **numbers: Any) -> None:
        """See Formulation.retune."""
        super().retune(**numbers)
        now = self.settings
        self.core.retune(now.regularization, now.null_damping, now.rest_damping)

    @property
    def is_compiled(self) -> bool:
        """Whether the core answers first: no subclass answers otherwise, and tasks are linear."""
        kind = type(self)
        plain = kind.solve is Cascade.solve and kind.answer is Cascade.answer
        return plain and not self.settings.second_order

    def cores_of(self, matrices: Iterable[Array], starts: Starts) -> tuple[Core | None, ...]:
        """The core's workspace for each matrix (k, k) of a mixture; None: it is no order."""
        orders = [self._orders.of(alpha, starts) for alpha in matrices]
        return tuple([order.core if order else None for order in orders])

    def answer(self, problem: ControlProblem) -> Solution:
        """See Formulation.answer: the core looks at the numbers itself."""
        return self.solve(problem)

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        return self.finish(problem, *self._by_core(problem))

    def finish(
        self, problem: ControlProblem, done: int, pivots: int, qps: int, answer: tuple[Any, ...]
    ) -> Solution:
        """Solution of what the core left open, if it did; arguments: `Mixture.solve`."""
        priorities, solver = problem.priorities, self.solver
        orders = self._orders.of_all(priorities, problem.starts)
        if done < 0 or (None in orders and problem.not_finite()):
            return super().answer(problem)
        if done < len(orders) or isinstance(priorities, PacedPriorities):
            return self._apart(problem, orders)
        solver.spend(pivots, qps)
        x, force, torque, violation, iterations, qp_solved, within = answer
        solution = Solution(
            x,
            force,
            torque,
            SolutionStatus.SOLVED,
            qp_solved,
            primal_residual=violation,
            iterations=iterations,
            violation=violation,
        )
        if problem.own_costs():
            solution = solution._replace(of_candidates=self.core.forces())
        return solution if within else self._within_rate(problem, solution)

    def reset(self) -> None:
        """See Formulation.reset."""
        super().reset()
        self._orders.forget()

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:
        """Orders always have an answer; a target that is none must have one by `balanced`."""
        general = BalancedGhc(self.settings, self.solver).solvability(jacobian, starts)
        return general._replace(along_ramp=False)

    def _by_core(self, problem: ControlProblem) -> tuple[int, int, int, tuple[Any, ...]]:
        """How many orders the core answered, its pivots and QPs, and the blend if it did all."""
        orders = self._orders.of_all(problem.priorities, problem.starts)
        settle = problem.second_order is None
        acceleration, torque, limit = problem.acceleration, problem.torque, problem.torque_limit
        solver = self.solver
        return self.core.solve(
            tuple([order.core if order and settle else None for order in orders]),
            tuple([candidate.share for candidate in problem.priorities.candidates]),
            problem.jacobian,
            problem.target,
            problem.mass_matrix,
            problem.bias,
            problem.velocity,
            acceleration.lower,
            acceleration.upper,
            torque.lower,
            torque.upper,
            limit.lower,
            limit.upper,
            problem.rows,
            problem.contacts,
            problem.unactuated,
            solver.lets_core_solve,
            solver.pivots_per_qp,
            solver.step_budget,
            solver.clock,
            solver.part_end,
            problem.own_costs(),
        )

    def _apart(self, problem: ControlProblem, orders: Sequence[Order | None]) -> Solution:
        """Answer candidate by candidate: those of the core, and what it left open."""
        limited = problem.limits_rate
        free = without_rate(problem) if limited else problem
        answers = []
        for index, order in enumerate(orders):
            # None takes the pivots of another, or those of the torque rate limit.
            self.solver.begin_part(len(orders) - index + limited)
            if order is None:
                balanced = BalancedGhc(self.settings, self.solver)
                answers.append(balanced.solve(free.of_candidate(index)))
            else:
                answers.append(self._of_order(free, index, order))
        answer = with_forces(blend(answers, problem.priorities), answers, problem)
        return self._within_rate(problem, answer) if limited else answer

    def _of_order(self, problem: ControlProblem, index: int, order: Order) -> Solution:
        """Answer of the core to one candidate, and of the levels that it left open."""
        solver, first, found = self.solver, 0, None
        if problem.second_order is None:
            first, pivots, qps, violation, x, force, torque = self.core.answer(
                index,
                solver.lets_core_solve,
                solver.pivots_per_qp,
                solver.pivots_left,
                solver.clock,
                solver.part_end,
            )
            solver.spend(pivots, qps)
            if first:
                found = Solution(
                    x,
                    force,
                    torque,
                    SolutionStatus.SOLVED,
                    qps > 0,
                    primal_residual=violation,
                    iterations=pivots,
                    violation=violation,
                )
        if found is not None and first == len(order.ends):
            return found
        reduced, forces = of_arrays(problem.of_candidate(index), self.core.reduced(index))
        return Descent(self.settings, solver, reduced, forces, order).answer(first, found)

    def _within_rate(self, problem: ControlProblem, answer: Solution) -> Solution:
        """The answer as far as the torque rate limit allows it."""
        self.solver.begin_part(1)
        reduced, forces = of_arrays(problem, self.core.reduced())
        return within_rate(reduced, forces, answer, self.settings, self.solver)

"""Transitions of a hierarchical QP by blending: one cascade per order, x = sum_c rho_c HQP_c."""

from __future__ import annotations

from typing import Any

from ghc_controller.formulations.cascade.blend import blend, with_forces
from ghc_controller.formulations.formulation import Formulation, FormulationSettings
from ghc_controller.formulations.hqp import Hqp
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.hierarchy.orders_only import orders_only
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array, Starts


@register_formulation
class HqpTransition(Formulation):
    """The HQP-based transition that RHP-HQP (2021) is compared with, as read from its text.

    Each candidate of a mixture of orders is answered by `hqp` with its settings, and the answers
    are blended: linear in the shares, feasible since the bounds are convex, and as many cascades
    per step as orders are active. A target that is no order is rejected.
    """

    name = "hqp_transition"
    blends = True

    def __init__(self, settings: FormulationSettings, solver: QpSolver) -> None:
        super().__init__(settings, solver)
        self._cascade = Hqp(settings, solver)

    def retune(self, **numbers: Any) -> None:
        """See Formulation.retune."""
        super().retune(**numbers)
        self._cascade.retune(**numbers)

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        count, answers = len(problem.priorities.candidates), []
        for index in range(count):
            self.solver.begin_part(count - index)  # none takes the pivots of another
            answers.append(self._cascade.solve(problem.of_candidate(index)))
        return with_forces(blend(answers, problem.priorities), answers, problem)

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:  # noqa: ARG002
        """Orders always have an answer; any other target is rejected."""
        return orders_only(self.name)

"""Gradient-balanced GHC: one QP, the same priority matrix, and lexicographic accuracy."""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.formulations.formulation import Formulation
from ghc_controller.formulations.nearest_answer import nearest_answer
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.formulations.second_order import guarded_solve, projected_terms
from ghc_controller.hierarchy.levels import is_order
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem, reduce_contacts
from ghc_controller.problem.solution import Solution
from ghc_controller.types import Array, Starts

_GUARD = 0.02  # [-] of w: below it the target system is damped


@register_formulation
class BalancedGhc(Formulation):
    """Balance of projected gradients (design, section 3.2).

    With x measured from -kd v, [sum_i P_i J_i^T J_i + w I] x* = sum_i P_i J_i^T b_i is the damped
    lexicographic optimum at strict orders and linear in the P_i. The QP
    min 1/2 (x - x*)^T W (x - x*), W = sum_i gamma_i J_i^T J_i + I, decides what yields at bounds.
    """

    name = "balanced"
    layer_damping = 2.5e-6  # damps the motion where a task loses a direction, at 1e-5 m and less

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        reduced = reduce_contacts(problem)
        origin, wanted = reduced.about_rest(settings.rest_damping)
        target = origin
        if problem.second_order is not None and len(origin):
            target = origin + self._second_order_target(reduced, origin, wanted)
        elif len(origin):  # contacts may leave no motion
            moved, _ = native.balanced_target(
                reduced.jacobian,
                wanted,
                problem.starts,
                problem.alpha,
                settings.regularization,
                self.projector.rank_tolerance,
                self.projector.layer_damping,
                _GUARD * settings.regularization,
            )
            target = origin + moved
        return nearest_answer(reduced, target, problem.alpha, settings, self.solver)

    def _second_order_target(self, reduced: ReducedProblem, origin: Array, wanted: Array) -> Array:
        """x* - y_0, [sum P_i (J_i^T J_i + S_i) + w I] x* = sum P_i (J_i^T b_i - kd S_i v)."""
        source, w = reduced.source, self.settings.regularization
        system, projectors = native.balanced_system(
            reduced.jacobian,
            source.starts,
            source.alpha,
            w,
            self.projector.rank_tolerance,
            self.projector.layer_damping,
        )
        curved, pull = projected_terms(reduced, projectors, origin)
        right = -pull
        for i in np.flatnonzero(np.diag(source.alpha) < 1.0):
            part = slice(source.starts[i], source.starts[i + 1])
            right += projectors[i] @ (wanted[part] @ reduced.jacobian[part])
        return guarded_solve(system + curved, right, _GUARD * w)

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:
        """Smallest singular value of the system of x*, in units of w and with the sign of its det.

        The determinant is positive at every order of tasks; priorities in a circle can bring it
        through zero, where x* and the torques jump.
        """
        w, projector = self.settings.regularization, self.projector

        def measure(alpha: Array) -> float:
            if is_order(alpha):  # also of no task: all joints brake
                return 1.0
            system, _ = native.balanced_system(
                jacobian, starts, alpha, w, projector.rank_tolerance, projector.layer_damping
            )
            sign, _ = np.linalg.slogdet(system)
            return float(sign * np.linalg.svd(system, compute_uv=False)[-1] / w)

        return Solvability(
            measure,
            _GUARD,
            "the system of formulation balanced, which stands for (13b), would be singular: "
            "smallest singular value, over w and with the sign of the determinant,",
            "avoid circles, go through another order, or take a formulation that blends orders,",
        )

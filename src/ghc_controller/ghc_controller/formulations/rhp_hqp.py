"""RHP-HQP: a hierarchical QP whose null spaces change continuously with the priorities.

G. Han et al., Recursive Hierarchical Projection for Whole-Body Control with Task Priority
Transition, 2021; numbers of equations are those of the paper.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.formulations.best_answer import BestAnswer
from ghc_controller.formulations.cascade.force_center import ForceCenter, balanced_contacts
from ghc_controller.formulations.cascade.level_answers import (
    UPPER_FORCE_WEIGHT,
    free_answer,
    keep_feasible,
    reduced_acceleration,
    rows_of,
)
from ghc_controller.formulations.formulation import Formulation, FormulationSettings
from ghc_controller.formulations.registry import register_formulation
from ghc_controller.hierarchy.level_slots import LevelSlots
from ghc_controller.hierarchy.orders_only import orders_only
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.bounded_qp import solve_qp
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array, Starts


@register_formulation
class RhpHqp(Formulation):
    """Levels one after the other, each in the recursive hierarchical projection of those above.

    Phi (l, k) mixes the candidates of the priorities (eq. 11). Level i solves for the tasks whose
    phi changes there, with J, b their rows, highest phi first, and Lambda = diag(phi) per row:

        min_u |Lambda^1/2 (J P u - Lambda (b - J x))|^2 + w |u|^2  subject to all bounds (eq. 7, 8)
        x <- x + P u (eq. 9),  P <- P (I - B^T Lambda B), B a basis of the rows of J P (eq. 5)

    What is chosen here:

    - Rows count with the root of their phi. The paper's weight is lost in print; a constant one
      (`rhp_constant_weights`) is that of the authors' library, and jumps at the ends of a swap.
    - P is multiplied from the right: only then J P = 0 holds for a task with phi = 1.
    - Rank: a row counts as a direction if `rank_tolerance` of its length is left in J P.
    - Bounds are those of all levels at every level; damping and contact forces are as in `hqp`.
    - A target that is no order is rejected. Given one anyway, alpha > 1/2 counts as "above".
    """

    name = "rhp_hqp"
    takes_second_order = False

    def __init__(self, settings: FormulationSettings, solver: QpSolver) -> None:
        super().__init__(settings, solver)
        self._slots = LevelSlots()

    def solve(self, problem: ControlProblem) -> Solution:
        """See Formulation.solve."""
        settings = self.settings
        phi = self._slots.priority_matrix(problem.priorities.candidates)
        levels = _levels(problem.starts, phi)
        reduced, forces = balanced_contacts(problem)
        d = reduced.jacobian.shape[1]
        y, projector = np.zeros(d), np.eye(d)
        if settings.hqp_damps_velocity:
            y, _ = reduced.about_rest(settings.velocity_damping)
        best = BestAnswer(problem, len(levels))
        for depth, (rows, share) in enumerate(levels):
            is_last = depth + 1 == len(levels)
            jacobian = reduced.jacobian[rows]
            local = jacobian @ projector
            wanted = share * (reduced.target[rows] - jacobian @ y)  # eq. 8
            weight = np.ones(len(rows)) if settings.rhp_constant_weights else np.sqrt(share)
            A, r = weight[:, None] * local, weight * wanted
            factor = native.inverse_factor(A.T @ A + settings.regularization * np.eye(d))
            optimum = y + projector @ (factor @ (factor.T @ (A.T @ r)))
            found = self._bounded(reduced, forces, optimum, projector @ factor, is_last)
            if not best.accept(depth, found):
                break
            y = reduced_acceleration(reduced, found.acceleration)
            reduced = keep_feasible(reduced, found)
            if not is_last:
                projector = recursive_projection(
                    projector, jacobian, share, settings.rank_tolerance
                )
        return best.answer

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:  # noqa: ARG002
        """Orders always have an answer; any other target is rejected."""
        return orders_only(self.name)

    def _bounded(
        self,
        reduced: ReducedProblem,
        forces: ForceCenter,
        best: Array,
        whitened: Array,
        is_last: bool,
    ) -> Solution:
        """Answer of a level with the optimum `best` (d,); a QP only where it meets a bound."""
        found = free_answer(reduced, forces, best)
        if found is not None:
            return found
        weight = 1.0 if is_last else UPPER_FORCE_WEIGHT
        factor = np.ascontiguousarray(whitened)
        parametrization = forces.parametrization(reduced, best, factor, weight)
        return solve_qp(reduced, parametrization, self.solver)


def _levels(starts: Starts, phi: Array) -> list[tuple[Starts, Array]]:
    """Rows (m,) of the tasks whose phi changes at a level, highest phi first, and their phi (m,).

    Levels where nothing changes are left out; without an active task one of no row is left.

    Args:
        phi: (l, k) Phi.
    """
    found = []
    before = np.zeros(phi.shape[1])
    for now in phi:
        chosen = np.flatnonzero(now != before)
        if len(chosen):
            chosen = chosen[np.argsort(-now[chosen], kind="stable")]
            share = np.repeat(now[chosen], starts[chosen + 1] - starts[chosen])
            found.append((rows_of(starts, chosen.tolist()), share))
        before = now
    return found or [(rows_of(starts, []), np.zeros(0))]


def recursive_projection(
    projector: Array, jacobian: Array, share: Array, rank_tolerance: float
) -> Array:
    """P (I - B^T Lambda B) (eq. 3 to 5), (d, d).

    B is the orthonormal basis of the rows of J P, made in the given order by Gram-Schmidt with two
    passes; Lambda holds the share of the row that each direction came from.

    Args:
        projector: (d, d) P of the levels above.
        jacobian: (m, d) rows of the level, highest share first.
        share: (m,) phi of each row.
        rank_tolerance: [-] of the length of a row of J; what is left of it in J P and less is
            rounding.
    """
    basis, kept = np.zeros((0, projector.shape[0])), []
    for row, phi in zip(jacobian, share, strict=True):
        left = row @ projector
        for _ in range(2):  # the second pass removes the rounding of the first
            left = left - basis.T @ (basis @ left)
        length = float(np.linalg.norm(left))
        if length > rank_tolerance * float(np.linalg.norm(row)):
            basis = np.vstack([basis, left / length])
            kept.append(phi)
    removed: Array = (projector @ basis.T) @ (np.array(kept)[:, None] * basis)
    return projector - removed

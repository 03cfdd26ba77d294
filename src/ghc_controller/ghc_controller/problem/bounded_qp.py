"""From an affine parametrization of (x, f) and a cost to a bounded solution.

Every formulation ends here: rows are built from the same parametrization, solved, and relaxed in a
fixed order if they conflict: soft acceleration rows, torque rate, normal force bounds; beyond that
there is no solution. A soft row is relaxed by the least amount that is needed, before tasks are
weighed.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ghc_controller.core import native
from ghc_controller.problem.acceptance import accept, in_words, judged
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization, build_qp
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.relaxation import Relaxation, relax
from ghc_controller.problem.solution import NO_FORCE, Solution, SolutionStatus
from ghc_controller.problem.violation import largest_violation
from ghc_controller.qp import VIOLATION_TOLERANCE, QpSolver
from ghc_controller.types import Array, Bounds


def unbounded_answer(reduced: ReducedProblem, y: Array) -> Solution | None:
    """Solution of accelerations (d,) that meet every bound of a fixed base; else None.

    With an unconstrained optimum at `y` no QP is needed then. An unactuated base always needs one.
    """
    source = reduced.source
    if source.unactuated > 0:
        return None
    return bounded_answer(
        reduced, y, NO_FORCE if source.contacts is None else source.contacts.force_center
    )


def bounded_answer(reduced: ReducedProblem, y: Array, force: Array) -> Solution | None:
    """Solution of accelerations y (d,) and forces (c,) if they meet every bound; else None.

    The balance of an unactuated base is not checked.
    """
    source, rows, contacts = reduced.source, reduced.source.rows, reduced.source.contacts
    box, torque = source.acceleration, source.torque
    if reduced.basis is None:
        if rows is not None and not native.rows_inside(rows.matrix, y, rows.lower, rows.upper):
            return None
        inside, tau = native.torques_inside(
            y, source.mass_matrix, source.bias, box.lower, box.upper, torque.lower, torque.upper
        )
        return Solution.unbounded(y, tau) if inside else None
    if contacts is not None and not native.rows_inside(
        contacts.force_matrix, force, contacts.force_lower, contacts.force_upper
    ):
        return None
    x, tau = reduced.answer(y, force)
    inside = native.is_inside(x, box.lower, box.upper) and native.is_inside(
        tau, torque.lower, torque.upper
    )
    if rows is not None:
        inside = inside and native.is_inside(rows.values(x, force), rows.lower, rows.upper)
    return Solution.unbounded(x, tau, force) if inside else None


def solve_bounded(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    solver: QpSolver,
) -> Solution:
    """Answer nearest to the optimum s = 0 that meets the bounds; no QP where that one does."""
    answer = unbounded_answer(reduced, parametrization.acceleration)
    if answer is not None:
        return answer
    return solve_qp(reduced, parametrization, solver)


def solve_qp(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    solver: QpSolver,
    hessian: Array | None = None,
    gradient: Array | None = None,
) -> Solution:
    """Bounded answer by a QP in any case; with no `hessian`, cost 1/2 |s|^2.

    SOLVED says that no row is violated by more than VIOLATION_TOLERANCE, recomputed from the
    answer, and that it is optimal. Rows are relaxed only if no solution was found otherwise.
    """
    source = reduced.source
    cost = _cost(parametrization, hessian, gradient)
    qp = build_qp(reduced, parametrization, *cost, source.torque)
    result, check = solver.solve_checked(qp.problem, qp.row_norm)
    answer = accept(reduced, reduced, parametrization, source.torque, result, check)
    if answer is not None:
        return answer
    reason = in_words(result)
    if result.reason:  # not finite, or no pivot left: nothing further can be solved
        return Solution.without_answer(source, reason)
    for torque, with_forces in _stages(source):
        relaxation = relax(reduced, parametrization, solver, torque, with_forces)
        if relaxation is None:
            continue
        answer = _within(reduced, relaxation, parametrization, solver, torque, cost)
        if answer is not None:
            return answer
    return Solution.without_answer(source, reason)


def _stages(source: ControlProblem) -> list[tuple[Bounds, bool]]:
    """Torque box, and whether normal force bounds are relaxed too, in the order of relaxation."""
    stages = [(source.torque, False)]
    if source.limits_rate:
        stages.append((source.torque_limit, False))
    if source.contacts is not None and source.contacts.bounds:
        stages.append((source.torque_limit, True))
    return stages


def _within(
    reduced: ReducedProblem,
    relaxation: Relaxation,
    parametrization: Parametrization,
    solver: QpSolver,
    torque: Bounds,
    cost: tuple[Array, Array],
) -> Solution | None:
    """Optimum within the widened bounds, or the feasible answer that showed them to be enough."""
    wider = relaxation.reduced
    qp = build_qp(wider, parametrization, *cost, torque)
    result, check = solver.solve_checked(qp.problem, qp.row_norm)
    answer = accept(reduced, wider, parametrization, torque, result, check)
    reason = ""
    if answer is None:
        y, force = relaxation.acceleration, relaxation.force
        answer = judged(reduced, wider, torque, y, force)
        reason = "feasible, not optimal: " + in_words(result)
    if answer is None:
        return None
    whole = largest_violation(
        reduced.source, answer.acceleration, answer.force, answer.torque, reduced.source.torque
    )
    if whole <= VIOLATION_TOLERANCE and not reason:  # nothing was relaxed noticeably
        return answer._replace(violation=whole)
    gave_way = torque is not reduced.source.torque and reduced.source.limits_rate
    return answer._replace(status=SolutionStatus.RELAXED, rate_gave_way=gave_way, reason=reason)


def _cost(
    parametrization: Parametrization, hessian: Array | None, gradient: Array | None
) -> tuple[Array, Array]:
    if hessian is None or gradient is None:
        return _unit_cost(parametrization.acceleration_factor.shape[1])
    return hessian, gradient


@lru_cache(maxsize=16)
def _unit_cost(p: int) -> tuple[Array, Array]:
    """Hessian and gradient of 1/2 |s|^2; no solver writes to its input."""
    return np.eye(p), np.zeros(p)

"""Whether an answer of a QP is accepted: optimal, and no row violated in physical units."""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.problem.violation import largest_violation
from ghc_controller.qp import VIOLATION_TOLERANCE, QpResult, Residuals
from ghc_controller.types import Array, Bounds


def accept(
    given: ReducedProblem,
    bounded: ReducedProblem,
    parametrization: Parametrization,
    torque: Bounds,
    result: QpResult,
    check: Residuals,
) -> Solution | None:
    """Solution of a QP answer that is optimal and violates no row of `bounded`; else None."""
    if not (result.found and check.optimal):
        return None
    y = parametrization.acceleration + parametrization.acceleration_factor @ result.x
    force = parametrization.force + parametrization.force_factor @ result.x
    answer = judged(given, bounded, torque, y, force)
    if answer is None:
        return None
    return answer._replace(dual_residual=check.dual, iterations=result.iterations)


def judged(
    given: ReducedProblem, bounded: ReducedProblem, torque: Bounds, y: Array, force: Array
) -> Solution | None:
    """Solution of y (d,) and f (c,) if it violates no row of `bounded`; slacks are to `given`."""
    x, tau = _box(bounded, y) if bounded.basis is None else bounded.answer(y, force)
    violation = largest_violation(bounded.source, x, force, tau, torque)
    if not violation <= VIOLATION_TOLERANCE:
        return None
    answer = Solution(
        x,
        force,
        tau,
        SolutionStatus.SOLVED,
        True,
        primal_residual=violation,
        violation=violation,
    )
    return answer if bounded is given else _with_slacks(given.source, answer)


def _with_slacks(source: ControlProblem, answer: Solution) -> Solution:
    """The answer, with how far it lies outside the soft rows of `source`."""
    x, box = answer.acceleration, source.acceleration
    contacts, rows = source.contacts, source.rows
    rows_slack, force_slack = None, None
    if contacts is not None:
        push = contacts.force_matrix @ answer.force
        force_slack = _excess(push, contacts.force_lower, contacts.force_upper)
    if rows is not None:
        rows_slack = _excess(rows.values(x, answer.force), rows.lower, rows.upper)
    return answer._replace(
        acceleration_slack=_excess(x, box.lower, box.upper),
        rows_slack=rows_slack,
        force_slack=force_slack,
    )


def _box(reduced: ReducedProblem, y: Array) -> tuple[Array, Array]:
    return y, reduced.torque_matrix @ y + reduced.torque_offset


def _excess(value: Array, lower: Array, upper: Array) -> Array | None:
    """How far `value` lies outside its bounds, (r,); None where it lies inside."""
    if native.largest_excess(value, lower, upper) <= VIOLATION_TOLERANCE:
        return None
    return np.maximum(np.maximum(lower - value, value - upper), 0.0)


def in_words(result: QpResult) -> str:
    """Why an answer was not accepted."""
    if result.found:
        return "the answer of the QP violates a row or is not optimal"
    return result.reason or f"QP: {result.status.value}"

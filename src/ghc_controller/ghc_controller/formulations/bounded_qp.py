"""From an affine parametrisation of (x, f) and a cost to a bounded answer, with what gives way.

Every formulation ends here: rows are built from the same parametrisation, solved, and when they
conflict relaxed in the order of the design: soft acceleration rows, torque rate, normal force
bounds, then no answer.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ghc_controller.formulations.box_kernels import (
    box_answer,
    is_inside,
    is_outside,
    rows_inside,
    torques_inside,
)
from ghc_controller.formulations.formulation import (
    NO_FORCE,
    FormulationSettings,
    Solution,
    SolutionStatus,
)
from ghc_controller.formulations.qp_rows import Parametrization, SoftQp, build_qp, soften
from ghc_controller.formulations.reduction import ReducedProblem
from ghc_controller.qp import QpResult, QpSolver, Residuals
from ghc_controller.types import Array

_ROW_TOLERANCE = 1e-5  # [rad/s^2] or [Nm] largest violation of a row in an accepted answer
_SLACK_COUNTS = 1e-6  # [rad/s^2] a soft row that gives way by less has not


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

    The balance of an unactuated base is not looked at.
    """
    source, rows, contacts = reduced.source, reduced.source.rows, reduced.source.contacts
    box, torque = source.acceleration, source.torque
    if reduced.basis is None:
        if rows is not None and not rows_inside(rows.matrix, y, rows.lower, rows.upper):
            return None
        inside, tau = torques_inside(
            y, source.mass_matrix, source.bias, box.lower, box.upper, torque.lower, torque.upper
        )
        return Solution.unbounded(y, tau) if inside else None
    if contacts is not None and not rows_inside(
        contacts.force_matrix, force, contacts.force_lower, contacts.force_upper
    ):
        return None
    x, tau = reduced.answer(y, force)
    inside = is_inside(x, box.lower, box.upper) and is_inside(tau, torque.lower, torque.upper)
    if rows is not None:
        inside = inside and rows_inside(rows.matrix, x, rows.lower, rows.upper)
    return Solution.unbounded(x, tau, force) if inside else None


def solve_bounded(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    solver: QpSolver,
    settings: FormulationSettings,
) -> Solution:
    """Answer nearest to the optimum s = 0 that meets the bounds; no QP where that one does."""
    answer = unbounded_answer(reduced, parametrization.acceleration)
    if answer is not None:
        return answer
    return solve_qp(reduced, parametrization, solver, settings)


def solve_qp(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    solver: QpSolver,
    settings: FormulationSettings,
    hessian: Array | None = None,
    gradient: Array | None = None,
) -> Solution:
    """Bounded answer by a QP in any case; with no `hessian`, cost 1/2 |s|^2."""
    source = reduced.source
    p = parametrization.acceleration_factor.shape[1]
    cost = _unit_cost(p) if hessian is None or gradient is None else (hessian, gradient)
    qp = build_qp(reduced, parametrization, *cost, source.torque)
    answer = _accept(reduced, parametrization, qp, *solver.solve_checked(qp.problem))
    if answer is not None:
        return answer
    stages = [(source.torque, qp.hard_start), (source.torque_limit, qp.hard_start)]
    if qp.bounds_end > qp.hard_start:
        stages.append((source.torque_limit, qp.bounds_end))
    for torque, soft in stages:
        qp = build_qp(reduced, parametrization, *cost, torque)
        softened = soften(qp, soft, settings.slack_weight)
        answer = _accept(reduced, parametrization, qp, *solver.solve_checked(softened))
        if answer is not None:
            return answer._replace(
                status=SolutionStatus.RELAXED, rate_gave_way=torque is not source.torque
            )
    nothing = np.full(reduced.torque_offset.shape[0], np.nan)
    return Solution(
        np.full(source.bias.shape[0], np.nan), np.zeros(0), nothing, SolutionStatus.FAILED, True
    )


@lru_cache(maxsize=16)
def _unit_cost(p: int) -> tuple[Array, Array]:
    """Hessian and gradient of 1/2 |s|^2; no solver writes to its input."""
    return np.eye(p), np.zeros(p)


def _accept(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    qp: SoftQp,
    result: QpResult,
    check: Residuals,
) -> Solution | None:
    """Solution of a QP answer whose residuals hold up, whatever the solver says of it."""
    if not result.found:
        return None
    if not (check.small or check.primal * np.max(qp.row_norm) <= _ROW_TOLERANCE):
        return None
    source = reduced.source
    s = result.x[: parametrization.acceleration_factor.shape[1]]
    force, rows_slack, force_slack = np.zeros(0), None, None
    contacts = source.contacts
    if reduced.basis is None:
        x, tau = box_answer(
            s,
            parametrization.acceleration,
            parametrization.acceleration_factor,
            reduced.torque_matrix,
            reduced.torque_offset,
        )
    else:
        y = parametrization.acceleration + parametrization.acceleration_factor @ s
        force = parametrization.force + parametrization.force_factor @ s
        x, tau = reduced.answer(y, force)
    if contacts is not None:
        push = contacts.force_matrix @ force
        force_slack = _excess(push, contacts.force_lower, contacts.force_upper)
    if source.rows is not None:
        rows_slack = _excess(source.rows.matrix @ x, source.rows.lower, source.rows.upper)
    return Solution(
        x,
        force,
        tau,
        SolutionStatus.SOLVED,
        True,
        check.primal,
        check.dual,
        result.iterations,
        _excess(x, source.acceleration.lower, source.acceleration.upper),
        rows_slack,
        force_slack,
    )


def _excess(value: Array, lower: Array, upper: Array) -> Array | None:
    """How far `value` lies outside its bounds, (r,); None where it lies inside."""
    if not is_outside(value, lower, upper, _SLACK_COUNTS):
        return None
    return np.maximum(np.maximum(lower - value, value - upper), 0.0)

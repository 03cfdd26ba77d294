"""From an affine parametrisation of (x, f) and a cost to a bounded answer, with what gives way.

Every formulation ends here: rows are built from the same parametrisation, solved, and when they
conflict relaxed in the order of the design: soft acceleration rows, torque rate, then no answer.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.formulations.formulation import FormulationSettings, Solution, SolutionStatus
from ghc_controller.formulations.kernels import meets_boxes
from ghc_controller.formulations.problem import ReducedProblem
from ghc_controller.qp import RESIDUAL_TOLERANCE, QpProblem, QpResult, QpSolver, residuals
from ghc_controller.types import Array, Bounds

_ROW_TOLERANCE = 1e-5  # [rad/s^2] or [Nm] largest violation of a row in an accepted answer
_SLACK_COUNTS = 1e-6  # [rad/s^2] a soft row that gives way by less has not


@dataclass(frozen=True, slots=True)
class Parametrization:
    """y = acceleration + acceleration_factor s, f = force + force_factor s; p entries in s."""

    acceleration: Array  # (d,)
    acceleration_factor: Array  # (d, p)
    force: Array  # (c,)
    force_factor: Array  # (c, p)

    @classmethod
    def whitened(
        cls, acceleration: Array, factor: Array, contact_rows: int, force_scale: float
    ) -> Parametrization:
        """Accelerations whitened by `factor` (d, r), forces by one scale: cost 1/2 |s|^2."""
        if contact_rows == 0:
            none = np.zeros((0, factor.shape[1]))
            return cls(acceleration, factor, np.zeros(0), none)
        d, r = factor.shape
        return cls(
            acceleration,
            np.hstack([factor, np.zeros((d, contact_rows))]),
            np.zeros(contact_rows),
            np.hstack([np.zeros((contact_rows, r)), force_scale * np.eye(contact_rows)]),
        )


@dataclass(frozen=True, slots=True)
class SoftQp:
    """A QP with normalised rows; rows before `hard_start` may give way."""

    problem: QpProblem
    hard_start: int
    row_norm: Array  # (r,) norms by which the rows were divided


def build_qp(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    hessian: Array,
    gradient: Array,
    torque: Bounds,
) -> SoftQp:
    """Rows on s: acceleration box, general rows (both soft); torque box, force rows (hard).

    Args:
        hessian: (p, p). gradient: (p,).
        torque: (a,) the torque box in force at this stage.
    """
    source = reduced.source
    factor = parametrization.acceleration_factor
    if reduced.basis is None:
        x_factor, x_offset = factor, parametrization.acceleration
    else:
        x_factor = reduced.basis @ factor
        x_offset = reduced.accelerations(parametrization.acceleration)
    blocks = [x_factor]
    lower = [source.acceleration.lower - x_offset]
    upper = [source.acceleration.upper - x_offset]
    if source.rows is not None:
        value = source.rows.matrix @ x_offset
        blocks.append(source.rows.matrix @ x_factor)
        lower.append(source.rows.lower - value)
        upper.append(source.rows.upper - value)
    hard_start = sum(block.shape[0] for block in blocks)
    tau = reduced.torque_offset + reduced.torque_matrix @ parametrization.acceleration
    tau = tau + reduced.torque_force @ parametrization.force
    blocks.append(
        reduced.torque_matrix @ factor + reduced.torque_force @ parametrization.force_factor
    )
    lower.append(torque.lower - tau)
    upper.append(torque.upper - tau)
    if source.contacts is not None:
        value = source.contacts.force_matrix @ parametrization.force
        blocks.append(source.contacts.force_matrix @ parametrization.force_factor)
        lower.append(source.contacts.force_lower - value)
        upper.append(source.contacts.force_upper - value)
    rows = np.vstack(blocks)
    norm = np.maximum(np.sqrt(np.einsum("ij,ij->i", rows, rows)), 1e-9)
    balance = (
        reduced.balance_matrix @ factor + reduced.balance_force @ parametrization.force_factor
    )
    balance_target = (
        reduced.balance_target
        - reduced.balance_matrix @ parametrization.acceleration
        - reduced.balance_force @ parametrization.force
    )
    problem = QpProblem(
        hessian,
        gradient,
        balance,
        balance_target,
        rows / norm[:, None],
        np.concatenate(lower) / norm,
        np.concatenate(upper) / norm,
    )
    return SoftQp(problem, hard_start, norm)


def soften(qp: SoftQp, slack_weight: float) -> QpProblem:
    """The same QP with a slack on every soft row, scaled so that its cost is 1/2 |slack|^2."""
    problem, soft = qp.problem, qp.hard_start
    p, r = problem.g.shape[0], problem.l.shape[0]
    hessian = np.eye(p + soft)
    hessian[:p, :p] = problem.H
    slack = np.zeros((r, soft))
    slack[:soft] = np.eye(soft) / np.sqrt(slack_weight)
    return QpProblem(
        hessian,
        np.concatenate([problem.g, np.zeros(soft)]),
        np.hstack([problem.A, np.zeros((problem.b.shape[0], soft))]),
        problem.b,
        np.hstack([problem.C, slack]),
        problem.l,
        problem.u,
    )


def unbounded_answer(reduced: ReducedProblem, y: Array) -> Solution | None:
    """Solution of accelerations (d,) that meet every bound of a fixed base; else None.

    With an unconstrained optimum at `y` no QP is needed then. Contact forces and an unactuated
    base always need one.
    """
    source = reduced.source
    if source.contacts is not None or source.unactuated > 0:
        return None
    if source.rows is not None:
        value = source.rows.matrix @ y
        if not ((source.rows.lower <= value) & (value <= source.rows.upper)).all():
            return None
    tau = source.mass_matrix @ y + source.bias
    box, torque = source.acceleration, source.torque
    if not meets_boxes(y, tau, box.lower, box.upper, torque.lower, torque.upper):
        return None
    return Solution.unbounded(y, tau)


def solve_bounded(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    solver: QpSolver,
    settings: FormulationSettings,
    hessian: Array | None = None,
    gradient: Array | None = None,
) -> Solution:
    """Answer nearest to the optimum that meets the bounds; with no `hessian`, cost 1/2 |s|^2."""
    source = reduced.source
    if hessian is None or gradient is None:
        answer = unbounded_answer(reduced, parametrization.acceleration)
        if answer is not None:
            return answer
    p = parametrization.acceleration_factor.shape[1]
    cost = (np.eye(p), np.zeros(p)) if hessian is None or gradient is None else (hessian, gradient)
    qp = build_qp(reduced, parametrization, *cost, source.torque)
    answer = _accept(reduced, parametrization, qp.problem, solver.solve(qp.problem), qp)
    if answer is not None:
        return answer
    for rate_gave_way, torque in ((False, source.torque), (True, source.torque_limit)):
        qp = build_qp(reduced, parametrization, *cost, torque)
        softened = soften(qp, settings.slack_weight)
        answer = _accept(reduced, parametrization, softened, solver.solve(softened), qp)
        if answer is not None:
            return replace(answer, status=SolutionStatus.RELAXED, rate_gave_way=rate_gave_way)
    nothing = np.full(reduced.torque_offset.shape[0], np.nan)
    return Solution(
        np.full(source.bias.shape[0], np.nan), np.zeros(0), nothing, SolutionStatus.FAILED, True
    )


def _accept(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    problem: QpProblem,
    result: QpResult,
    qp: SoftQp,
) -> Solution | None:
    """Solution of a QP answer whose residuals hold up, whatever the solver says of it."""
    if not result.found or not np.isfinite(result.x).all():
        return None
    check = residuals(problem, result)
    violation = check.primal * float(np.max(qp.row_norm))
    if violation > _ROW_TOLERANCE and check.relative(result) > RESIDUAL_TOLERANCE:
        return None
    s = result.x[: parametrization.acceleration_factor.shape[1]]
    y = parametrization.acceleration + parametrization.acceleration_factor @ s
    force = parametrization.force + parametrization.force_factor @ s
    x = reduced.accelerations(y)
    tau = reduced.torque_offset + reduced.torque_matrix @ y + reduced.torque_force @ force
    box, rows = reduced.source.acceleration, reduced.source.rows
    rows_slack = None
    if rows is not None:
        rows_slack = _excess(rows.matrix @ x, Bounds(rows.lower, rows.upper))
    return Solution(
        x,
        force,
        tau,
        SolutionStatus.SOLVED,
        True,
        check.primal,
        check.dual,
        result.iterations,
        _excess(x, box),
        rows_slack,
    )


def _excess(value: Array, bounds: Bounds) -> Array | None:
    """How far `value` lies outside its bounds, (r,); None where it lies inside."""
    excess = np.maximum(np.maximum(bounds.lower - value, value - bounds.upper), 0.0)
    return excess if (excess > _SLACK_COUNTS).any() else None

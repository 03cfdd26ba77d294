"""Rows of the bounded QP on the variables s of an affine parametrisation of (x, f)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.formulations.box_kernels import box_rows, normalize_rows
from ghc_controller.formulations.problem import ContactRows
from ghc_controller.formulations.reduction import ReducedProblem
from ghc_controller.qp import QpProblem
from ghc_controller.types import Array, Bounds


class Parametrization(NamedTuple):
    """y = acceleration + acceleration_factor s, f = force + force_factor s; p entries in s."""

    acceleration: Array  # (d,)
    acceleration_factor: Array  # (d, p)
    force: Array  # (c,)
    force_factor: Array  # (c, p)

    @classmethod
    def whitened(
        cls, acceleration: Array, factor: Array, contacts: ContactRows | None, scale: float = 1.0
    ) -> Parametrization:
        """Accelerations whitened by `factor` (d, r), forces by their own: cost 1/2 |s|^2.

        `scale` is the root of the weight on all task errors, where that is not one.
        """
        if contacts is None:
            none = np.zeros((0, factor.shape[1]))
            return cls(acceleration, factor, np.zeros(0), none)
        d, r = factor.shape
        c = contacts.force_center.shape[0]
        acceleration_factor, force_factor = np.zeros((d, r + c)), np.zeros((c, r + c))
        acceleration_factor[:, :r] = factor
        force_factor[:, r:] = scale * contacts.force_factor
        return cls(acceleration, acceleration_factor, contacts.force_center, force_factor)


class SoftQp(NamedTuple):
    """A QP with normalised rows; those before `hard_start` may give way, then the force bounds."""

    problem: QpProblem
    hard_start: int
    bounds_end: int  # end of the normal force bounds, which follow
    row_norm: Array  # (r,) norms by which the rows were divided


def build_qp(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    hessian: Array,
    gradient: Array,
    torque: Bounds,
) -> SoftQp:
    """Rows on s: acceleration box, general rows (both soft), force bounds, cones, torque box.

    Args:
        hessian: (p, p). gradient: (p,).
        torque: (a,) the torque box in force at this stage.
    """
    source, factor = reduced.source, parametrization.acceleration_factor
    if source.contacts is None and source.rows is None:
        hard_start = bounds_end = factor.shape[0]
        rows, lower, upper, norm = box_rows(
            parametrization.acceleration,
            factor,
            reduced.torque_matrix,
            reduced.torque_offset,
            source.acceleration.lower,
            source.acceleration.upper,
            torque.lower,
            torque.upper,
        )
    else:
        rows, lower, upper, hard_start = _all_rows(reduced, parametrization, torque)
        norm = normalize_rows(rows, lower, upper)
        contacts = source.contacts
        bounds_end = hard_start + (0 if contacts is None else contacts.bounds)
    problem = QpProblem(hessian, gradient, *_balance(reduced, parametrization), rows, lower, upper)
    return SoftQp(problem, hard_start, bounds_end, norm)


def _all_rows(
    reduced: ReducedProblem, parametrization: Parametrization, torque: Bounds
) -> tuple[Array, Array, Array, int]:
    """Rows (r, p), their bounds (r,), and how many of them are soft."""
    source, factor = reduced.source, parametrization.acceleration_factor
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
    if source.contacts is not None:
        value = source.contacts.force_matrix @ parametrization.force
        blocks.append(source.contacts.force_matrix @ parametrization.force_factor)
        lower.append(source.contacts.force_lower - value)
        upper.append(source.contacts.force_upper - value)
    tau = reduced.torque_offset + reduced.torque_matrix @ parametrization.acceleration
    tau = tau + reduced.torque_force @ parametrization.force
    blocks.append(
        reduced.torque_matrix @ factor + reduced.torque_force @ parametrization.force_factor
    )
    lower.append(torque.lower - tau)
    upper.append(torque.upper - tau)
    return np.vstack(blocks), np.concatenate(lower), np.concatenate(upper), hard_start


def _balance(reduced: ReducedProblem, parametrization: Parametrization) -> tuple[Array, Array]:
    """Equations of motion of the unactuated coordinates on s: (u, p) and (u,)."""
    factor = parametrization.acceleration_factor
    if reduced.source.unactuated == 0:
        return np.zeros((0, factor.shape[1])), np.zeros(0)
    matrix = reduced.balance_matrix @ factor + reduced.balance_force @ parametrization.force_factor
    target = (
        reduced.balance_target
        - reduced.balance_matrix @ parametrization.acceleration
        - reduced.balance_force @ parametrization.force
    )
    return matrix, target


def soften(qp: SoftQp, soft: int, slack_weight: float) -> QpProblem:
    """The same QP with a slack on the first `soft` rows, scaled so that it costs 1/2 |slack|^2."""
    problem = qp.problem
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

"""Rows of the bounded QP on the variables s of an affine parametrization of (x, f)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.core import native
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.qp import QpProblem
from ghc_controller.types import Array, Bounds


class Parametrization(NamedTuple):
    """y = acceleration + acceleration_factor s, f = force + force_factor s; p entries in s."""

    acceleration: Array  # (d,)
    acceleration_factor: Array  # (d, p)
    force: Array  # (c,)
    force_factor: Array  # (c, p)
    balanced: bool = False  # True: every s meets the equations of motion of the base

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
    """A QP with normalized rows; rows before `hard_start` are relaxed first, then force bounds."""

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
    """Rows on s: acceleration box, soft rows, force bounds, cones, torque box, hard rows.

    Args:
        hessian: (p, p). gradient: (p,).
        torque: (a,) the torque box in force at this stage.
    """
    source = reduced.source
    general, contacts = source.rows, source.contacts
    soft = 0 if general is None else general.soft
    rows, lower, upper, norm = native.qp_rows(
        reduced.basis,
        reduced.offset,
        parametrization,
        source.acceleration.lower,
        source.acceleration.upper,
        general,
        soft,
        contacts,
        reduced.torque_matrix,
        reduced.torque_offset,
        reduced.torque_force,
        torque.lower,
        torque.upper,
    )
    hard_start = source.bias.shape[0] + soft
    bounds_end = hard_start + (0 if contacts is None else contacts.bounds)
    problem = QpProblem(hessian, gradient, *_balance(reduced, parametrization), rows, lower, upper)
    return SoftQp(problem, hard_start, bounds_end, norm)


def _balance(reduced: ReducedProblem, parametrization: Parametrization) -> tuple[Array, Array]:
    """Equations of motion of the unactuated coordinates on s: (u, p) and (u,)."""
    factor = parametrization.acceleration_factor
    if reduced.source.unactuated == 0 or parametrization.balanced:
        return np.zeros((0, factor.shape[1])), np.zeros(0)
    matrix = reduced.balance_matrix @ factor + reduced.balance_force @ parametrization.force_factor
    target = (
        reduced.balance_target
        - reduced.balance_matrix @ parametrization.acceleration
        - reduced.balance_force @ parametrization.force
    )
    return matrix, target


def soften(qp: SoftQp, first: int, last: int) -> QpProblem:
    """The same QP with a slack on rows first .. last, and without the rows before them.

    A slack has the physical units of its row ([rad/s^2] or [N]) and costs 1/2 slack^2. Bounds of a
    soft row that exclude each other are both met half-way.
    """
    problem = qp.problem
    lower, upper = problem.l[first:].copy(), problem.u[first:].copy()
    crossed = np.flatnonzero(lower[: last - first] > upper[: last - first])
    lower[crossed] = upper[crossed] = 0.5 * (lower[crossed] + upper[crossed])
    p, soft = problem.g.shape[0], last - first
    hessian = np.eye(p + soft)
    hessian[:p, :p] = problem.H
    slack = np.zeros((problem.l.shape[0] - first, soft))
    slack[:soft] = np.diag(1.0 / qp.row_norm[first:last])
    return QpProblem(
        hessian,
        np.concatenate([problem.g, np.zeros(soft)]),
        np.hstack([problem.A, np.zeros((problem.b.shape[0], soft))]),
        problem.b,
        np.hstack([problem.C[first:], slack]),
        lower,
        upper,
    )

"""Least relaxation of the soft rows, in physical units, found before any task is weighed.

First of a lexicographic pair: the slack is found here and the bounds are widened by just that
much; the tasks then compete within them (`bounded_qp`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.problem.qp_rows import Parametrization, build_qp, soften
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array, Bounds

_MARGIN = 1e-7  # [rad/s^2], [N] by which bounds are wider than the least slack asks for
_SPAN = 1e-12  # [-] of the largest singular value: a direction below it cannot be used
# [-] root of the weight of a step in (y, f) against the slack, which breaks ties: the first finds
# the active rows in few pivots, the last leaves no slack to the ties.
_PULLS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-5, 1e-5)
_CONVERGED = 1e-8  # [rad/s^2], [N] change of the slack that ends them


class Relaxation(NamedTuple):
    """A problem with soft bounds so wide that an answer exists, and one such answer."""

    reduced: ReducedProblem  # with the wider bounds
    acceleration: Array  # (d,) y, feasible and near the optimum without bounds
    force: Array  # (c,)
    slack: float  # [rad/s^2] or [N] the largest one


def relax(
    reduced: ReducedProblem,
    parametrization: Parametrization,
    solver: QpSolver,
    torque: Bounds,
    with_forces: bool,
) -> Relaxation | None:
    """The problem with soft rows widened by the least sum of squared slacks that allows an answer.

    Args:
        parametrization: spans the accelerations and forces that may be used.
        torque: (a,) the torque box, which is kept.
        with_forces: relax normal force bounds first, by the least that allows a solution; else
        they are kept.

    Returns:
        None where rows that are kept exclude each other, or no solution was found.
    """
    start = _spanned(parametrization)
    if start.acceleration_factor.shape[1] == 0:
        return None  # nothing can be chosen
    slack = 0.0
    if with_forces:
        found = _least_slack(reduced, start, solver, torque, forces=True)
        if found is None:
            return None
        contacts, force = reduced.source.contacts, found[1]
        assert contacts is not None
        widened, slack = _wider_forces(contacts, force)
        reduced = reduced._replace(source=replace(reduced.source, contacts=widened))
    found = _least_slack(reduced, start, solver, torque, forces=False)
    if found is None:
        return None
    y, force = found
    source, soft_slack = _wider_rows(reduced.source, reduced.accelerations(y), force)
    return Relaxation(reduced._replace(source=source), y, force, max(slack, soft_slack))


def _spanned(parametrization: Parametrization) -> Parametrization:
    """The same accelerations and forces by an orthonormal basis."""
    d = parametrization.acceleration.shape[0]
    factor = np.vstack([parametrization.acceleration_factor, parametrization.force_factor])
    left, sigma, _ = np.linalg.svd(factor, full_matrices=False)
    basis = left[:, sigma > _SPAN * max(float(sigma.max(initial=0.0)), 1e-300)]
    return parametrization._replace(
        acceleration_factor=np.ascontiguousarray(basis[:d]),
        force_factor=np.ascontiguousarray(basis[d:]),
    )


def _least_slack(
    reduced: ReducedProblem,
    start: Parametrization,
    solver: QpSolver,
    torque: Bounds,
    forces: bool,
) -> tuple[Array, Array] | None:
    """Point (y, f) of the least sum of squared slacks; None where there is none.

    A proximal-point iteration: min 1/2 |slack|^2 + pull^2/2 |(y, f) - last|^2, again from the
    answer, so that what breaks ties costs no slack in the end.
    """
    size = start.acceleration_factor.shape[1]
    at, last = start, np.zeros(1)  # no slack needed at all: one step is enough
    point: tuple[Array, Array] | None = None
    for pull in _PULLS:
        at = at._replace(
            acceleration_factor=start.acceleration_factor / pull,
            force_factor=start.force_factor / pull,
        )
        qp = build_qp(reduced, at, np.eye(size), np.zeros(size), torque)
        first, end = (qp.hard_start, qp.bounds_end) if forces else (0, qp.hard_start)
        result, check = solver.solve_checked(soften(qp, first, end), qp.row_norm[first:])
        if not (result.found and check.small):
            break
        s, slack = result.x[:size], result.x[size:]
        y = at.acceleration + at.acceleration_factor @ s
        force = at.force + at.force_factor @ s
        point = (y, force)
        if np.max(np.abs(slack - last), initial=0.0) <= _CONVERGED:
            break
        at, last = at._replace(acceleration=y, force=force), slack
    return point


def _wider_rows(source: ControlProblem, x: Array, force: Array) -> tuple[ControlProblem, float]:
    """Acceleration box and soft rows that contain x (n,) and f (c,), and the largest slack."""
    acceleration, slack = _containing(source.acceleration, x)
    rows = source.rows
    if rows is not None:
        count = rows.soft
        given = Bounds(rows.lower[:count], rows.upper[:count])
        bounds, more = _containing(given, rows.values(x, force)[:count])
        lower = np.concatenate([bounds.lower, rows.lower[count:]])
        upper = np.concatenate([bounds.upper, rows.upper[count:]])
        rows, slack = rows._replace(lower=lower, upper=upper), max(slack, more)
    return replace(source, acceleration=acceleration, rows=rows), slack


def _wider_forces(contacts: ContactRows, force: Array) -> tuple[ContactRows, float]:
    """Normal force bounds that contain f (c,), and the largest slack; cones stay."""
    count = contacts.bounds
    given = Bounds(contacts.force_lower[:count], contacts.force_upper[:count])
    bounds, slack = _containing(given, contacts.force_matrix[:count] @ force)
    lower, upper = contacts.force_lower.copy(), contacts.force_upper.copy()
    lower[:count], upper[:count] = bounds.lower, bounds.upper
    return contacts._replace(force_lower=lower, force_upper=upper), slack


def _containing(bounds: Bounds, value: Array) -> tuple[Bounds, float]:
    """Bounds that contain `value`, with a margin where they do not; the largest slack."""
    lower, upper = bounds.lower, bounds.upper
    slack = np.maximum(np.maximum(lower - value, value - upper), 0.0)
    wider = Bounds(
        np.where(value < lower + _MARGIN, np.minimum(lower, value - _MARGIN), lower),
        np.where(value > upper - _MARGIN, np.maximum(upper, value + _MARGIN), upper),
    )
    return wider, float(np.max(slack, initial=0.0))

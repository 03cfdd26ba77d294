"""Data passed from level to level of a cascade: rows, and bounds around the solution above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ghc_controller.formulations.cascade.force_center import ForceCenter
from ghc_controller.problem.bounded_qp import bounded_answer
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.problem.violation import largest_violation
from ghc_controller.qp import VIOLATION_TOLERANCE
from ghc_controller.types import Array, Bounds, Starts

BALANCED = 1e-6  # [N], [Nm] left of the equations of motion of the base
UPPER_FORCE_WEIGHT = 1e-4  # [-] root of the weight on forces above the last level
_KEEP_FEASIBLE = 2e-8  # [rad/s^2], [Nm], [N] widening that keeps the answer of the level above


def rows_of(starts: Starts, tasks: Sequence[int]) -> Starts:
    """Indices of the rows of these tasks, (m,)."""
    parts = [np.arange(starts[i], starts[i + 1]) for i in tasks]
    return np.concatenate(parts) if parts else np.zeros(0, dtype=np.int64)


def reduced_acceleration(reduced: ReducedProblem, x: Array) -> Array:
    """(d,) y of accelerations x (n,) that keep the contacts."""
    if reduced.basis is None or reduced.offset is None:
        return x
    return reduced.basis.T @ (x - reduced.offset)


def free_answer(reduced: ReducedProblem, forces: ForceCenter, y: Array) -> Solution | None:
    """Answer of accelerations y (d,) and the forces for them, if they meet every bound."""
    force = forces.at(reduced, y)
    left = forces.residual - reduced.balance_matrix @ y
    open_ = left - reduced.balance_force @ (force - forces.center)
    if np.abs(open_).max(initial=0.0) > BALANCED:
        return None
    return bounded_answer(reduced, y, force)


def keep_feasible(reduced: ReducedProblem, found: Solution) -> ReducedProblem:
    """The same problem with bounds that contain the answer of the level above."""
    source = reduced.source
    rows, contacts = source.rows, source.contacts
    if rows is not None:
        value = rows.values(found.acceleration, found.force)
        lower, upper = _containing(rows.lower, rows.upper, value)
        rows = rows._replace(lower=lower, upper=upper)
    if contacts is not None:
        value = contacts.force_matrix @ found.force
        lower, upper = _containing(contacts.force_lower, contacts.force_upper, value)
        contacts = contacts._replace(force_lower=lower, force_upper=upper)
    acceleration, torque = source.acceleration, source.torque
    widened = replace(
        source,
        acceleration=Bounds(
            *_containing(acceleration.lower, acceleration.upper, found.acceleration)
        ),
        torque=Bounds(*_containing(torque.lower, torque.upper, found.torque)),
        rows=rows,
        contacts=contacts,
    )
    return reduced._replace(source=widened)


def keeps_bounds(problem: ControlProblem, worst: SolutionStatus, found: Solution) -> bool:
    """Whether an answer below the first level is optimal, and SOLVED ones within all bounds.

    Each level may use the tolerance of the bounds anew: what counts are those of the problem.

    Args:
        worst: status of the levels above.
    """
    if found.status is SolutionStatus.FAILED or found.reason:
        return False
    if worst is not SolutionStatus.SOLVED:
        return True
    answer = (found.acceleration, found.force, found.torque)
    return largest_violation(problem, *answer, problem.torque) <= VIOLATION_TOLERANCE


def _containing(lower: Array, upper: Array, value: Array) -> tuple[Array, Array]:
    return np.minimum(lower, value - _KEEP_FEASIBLE), np.maximum(upper, value + _KEEP_FEASIBLE)

"""How far an answer lies outside its rows, in physical units, recomputed from the answer."""

from __future__ import annotations

from ghc_controller.core import native
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.types import Array, Bounds


def largest_violation(
    problem: ControlProblem, acceleration: Array, force: Array, torque: Array, box: Bounds
) -> float:
    """Largest violation of any row by x (n,), f (c,) and tau (a,); inf where they are not finite.

    Rows: acceleration box [rad/s^2], general rows [their units], force rows [N], torque box [Nm],
    and M x + h = [0; tau] + J_f^T f [N], [Nm] of every coordinate.

    Args:
        box: (a,) the torque box in force, that of the problem unless the rate limit was relaxed.
    """
    contacts, rows = problem.contacts, problem.rows
    worst = native.box_violation(
        problem.mass_matrix,
        problem.bias,
        acceleration,
        torque,
        None if contacts is None else contacts.force_jacobian.T @ force,
        problem.acceleration.lower,
        problem.acceleration.upper,
        box.lower,
        box.upper,
    )
    if contacts is not None:
        push = contacts.force_matrix @ force
        worst = max(worst, native.largest_excess(push, contacts.force_lower, contacts.force_upper))
    if rows is not None:
        worst = max(
            worst, native.largest_excess(rows.values(acceleration, force), rows.lower, rows.upper)
        )
    return worst

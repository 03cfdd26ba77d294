"""How far an answer lies outside its rows, in physical units, recomputed from the answer."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ghc_controller.problem.box_kernels import affine
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.types import Array, Bounds

_NONE = np.zeros(0)


def largest_violation(
    problem: ControlProblem, acceleration: Array, force: Array, torque: Array, box: Bounds
) -> float:
    """Largest violation of any row by x (n,), f (c,) and tau (a,); inf where they are not finite.

    Rows: acceleration box [rad/s^2], general rows [their units], force rows [N], torque box [Nm],
    and M x + h = [0; tau] + J_f^T f [N], [Nm] of every coordinate.

    Args:
        box: (a,) the torque box in force, that of the problem unless the rate gave way.
    """
    contacts, rows = problem.contacts, problem.rows
    worst = _of_boxes(
        problem.mass_matrix,
        problem.bias,
        acceleration,
        torque,
        _NONE if contacts is None else contacts.force_jacobian.T @ force,
        problem.acceleration.lower,
        problem.acceleration.upper,
        box.lower,
        box.upper,
    )
    if contacts is not None:
        push = contacts.force_matrix @ force
        worst = max(worst, _outside(push, contacts.force_lower, contacts.force_upper))
    if rows is not None:
        worst = max(worst, _outside(rows.matrix @ acceleration, rows.lower, rows.upper))
    return worst


@njit(cache=True)
def _of_boxes(
    mass_matrix: Array,
    bias: Array,
    x: Array,
    tau: Array,
    push: Array,
    lower: Array,
    upper: Array,
    tau_lower: Array,
    tau_upper: Array,
) -> float:  # pragma: no cover
    """Largest violation of both boxes and of M x + h = [0; tau] + push, push (n,) or empty."""
    needed = affine(mass_matrix, x, bias)
    unactuated = needed.shape[0] - tau.shape[0]
    for r in range(needed.shape[0]):
        if r >= unactuated:
            needed[r] -= tau[r - unactuated]
        if push.shape[0]:
            needed[r] -= push[r]
    nothing = np.zeros(needed.shape[0])
    worst = max(_outside(x, lower, upper), _outside(tau, tau_lower, tau_upper))
    return max(worst, _outside(needed, nothing, nothing))


@njit(cache=True)
def _outside(value: Array, lower: Array, upper: Array) -> float:  # pragma: no cover
    """Largest distance of an entry from its bounds; inf for NaN."""
    worst = 0.0
    for r in range(value.shape[0]):
        if not math.isfinite(value[r]):
            return math.inf
        worst = max(worst, lower[r] - value[r], value[r] - upper[r])
    return worst

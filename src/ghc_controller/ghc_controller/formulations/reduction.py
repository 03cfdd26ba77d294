"""The control problem without the accelerations that would break a contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from ghc_controller.formulations.problem import ControlProblem
from ghc_controller.types import Array

FIXED = 1e-8  # [-] of a task row's length: what is left of one that a contact holds
_RANK_TOLERANCE = 1e-9  # [-] of the largest singular value of the contacts' motion rows


class ReducedProblem(NamedTuple):
    """The control problem in accelerations y that keep every contact: x = offset + basis y.

    Without contacts basis = I and offset = 0 and nothing is copied. d = number of y, c of forces.
    """

    jacobian: Array  # (m, d) J Z
    target: Array  # (m,) b - J x_c
    basis: Array | None  # (n, d) Z, orthonormal null space of J_c; None = identity
    offset: Array | None  # (n,) x_c; None = zero
    torque_matrix: Array  # (a, d) tau = torque_matrix y + torque_offset + torque_force f
    torque_offset: Array  # (a,)
    torque_force: Array  # (a, c) -J_c^T of the joints
    balance_matrix: Array  # (u, d) unactuated rows: balance_matrix y + balance_force f = rhs
    balance_force: Array  # (u, c)
    balance_target: Array  # (u,)
    source: ControlProblem

    def accelerations(self, y: Array) -> Array:
        """(n,) x of reduced accelerations y (d,)."""
        if self.basis is None or self.offset is None:
            return y
        return self.offset + self.basis @ y


def reduce_contacts(problem: ControlProblem) -> ReducedProblem:
    """Remove the accelerations that would break a contact (thesis, eq. 5.1).

    Projectors and task variables then live in the null space of J_c, so that a task of high
    priority is never asked to move a contact.
    """
    u, contacts = problem.unactuated, problem.contacts
    if contacts is None:
        n = problem.bias.shape[0]
        return ReducedProblem(
            problem.jacobian,
            problem.target,
            None,
            None,
            problem.mass_matrix[u:],
            problem.bias[u:],
            np.zeros((n - u, 0)),
            problem.mass_matrix[:u],
            np.zeros((u, 0)),
            -problem.bias[:u],
            problem,
        )
    offset, basis = null_motion(contacts.jacobian, contacts.drift_target)
    torque_matrix = problem.mass_matrix @ basis
    torque_offset = problem.bias + problem.mass_matrix @ offset
    force = -contacts.force_jacobian.T
    jacobian = np.ascontiguousarray(problem.jacobian @ basis)
    target = problem.target - problem.jacobian @ offset
    clear_fixed_rows(problem.jacobian, jacobian, target)
    return ReducedProblem(
        jacobian,
        target,
        basis,
        offset,
        torque_matrix[u:],
        torque_offset[u:],
        force[u:],
        torque_matrix[:u],
        force[:u],
        -torque_offset[:u],
        problem,
    )


@njit(cache=True)
def clear_fixed_rows(before: Array, jacobian: Array, target: Array) -> None:  # pragma: no cover
    """Zero rows of which the contacts leave only rounding: noise is no direction to project on."""
    for r in range(before.shape[0]):
        whole, left = 0.0, 0.0
        for c in range(before.shape[1]):
            whole += before[r, c] * before[r, c]
        for c in range(jacobian.shape[1]):
            left += jacobian[r, c] * jacobian[r, c]
        if left <= FIXED * FIXED * whole:
            jacobian[r] = 0.0
            target[r] = 0.0


def null_motion(rows: Array, target: Array) -> tuple[Array, Array]:
    """Least x (n,) with rows x = target, and an orthonormal basis (n, d) of rows x = 0.

    Rows (q, n) that depend on others are met in the least-squares sense.
    """
    q, n = rows.shape
    if q <= n:
        full, triangle = np.linalg.qr(rows.T, mode="complete")
        pivots = np.abs(np.diag(triangle))
        if pivots.min(initial=np.inf) > 1e-4 * pivots.max(initial=0.0):
            least = full[:, :q] @ np.linalg.solve(triangle[:q].T, target)
            return least, np.ascontiguousarray(full[:, q:])
    left, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > _RANK_TOLERANCE * max(float(sigma[0]), 1e-300)))
    least = right[:rank].T @ ((left[:, :rank].T @ target) / sigma[:rank])
    return least, np.ascontiguousarray(right[rank:].T)

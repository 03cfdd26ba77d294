"""The control problem without the accelerations that would break a contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.problem.box_kernels import contact_answer
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction_kernels import null_motion_qr, reduced_terms
from ghc_controller.types import Array

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

    def about_rest(self, kd: float) -> tuple[Array, Array]:
        """Origin y_0 (d,) of accelerations -kd v [1/s], and b - J y_0 (m,).

        Damping of y - y_0 brings motions that no task claims to rest.
        """
        brake = -kd * self.source.velocity
        origin = brake if self.basis is None else self.basis.T @ brake
        return origin, self.target - self.jacobian @ origin

    def answer(self, y: Array, force: Array) -> tuple[Array, Array]:
        """Accelerations (n,) and torques (a,) of y (d,) and contact forces (c,) in contact."""
        return contact_answer(
            y,
            force,
            self.offset,
            self.basis,
            self.torque_matrix,
            self.torque_offset,
            self.torque_force,
        )


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
    jacobian, target, torque_matrix, torque_offset, force = reduced_terms(
        problem.jacobian,
        problem.target,
        problem.mass_matrix,
        problem.bias,
        contacts.force_jacobian,
        offset,
        basis,
    )
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


def kept_by_contacts(jacobian: Array, contact_jacobian: Array) -> Array:
    """(m, d) task rows (m, n) in the accelerations that contact rows (q, n) leave."""
    m, n = jacobian.shape
    offset, basis = null_motion(contact_jacobian, np.zeros(contact_jacobian.shape[0]))
    nothing = np.zeros((0, n))
    return reduced_terms(jacobian, np.zeros(m), nothing, np.zeros(0), nothing, offset, basis)[0]


def null_motion(rows: Array, target: Array) -> tuple[Array, Array]:
    """Least x (n,) with rows x = target, and an orthonormal basis (n, d) of rows x = 0.

    Rows (q, n) that depend on others are met in the least-squares sense.
    """
    q, n = rows.shape
    if q <= n:
        independent, least, basis = null_motion_qr(rows, target)
        if independent:
            return least, basis
    left, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > _RANK_TOLERANCE * max(float(sigma[0]), 1e-300)))
    least = right[:rank].T @ ((left[:, :rank].T @ target) / sigma[:rank])
    return least, np.ascontiguousarray(right[rank:].T)

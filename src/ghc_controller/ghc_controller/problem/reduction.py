"""The control problem without the accelerations that would break a contact."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ghc_controller.core import native
from ghc_controller.problem.control_problem import ContactRows, ControlProblem
from ghc_controller.types import Array

_NONE, _NO_ROWS = np.zeros(0), np.zeros((0, 0))


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
        assert self.offset is not None
        assert self.basis is not None
        return native.contact_answer(
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

    Projectors and task variables then live in the null space of J_c, so that no task can demand a
    motion of a contact.
    """
    if problem.contacts is not None:
        return ReducedProblem._make((*reduced_arrays(problem, balance=False)[:10], problem))
    u, n = problem.unactuated, problem.bias.shape[0]
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


def reduced_arrays(problem: ControlProblem, balance: bool) -> tuple[Any, ...]:
    """Fields of ReducedProblem up to `source`, then of ForceCenter, by the core.

    Args:
        balance: whether to remove what forces cannot balance too (`balanced_contacts`).
    """
    return native.reduced(
        problem.jacobian,
        problem.target,
        problem.mass_matrix,
        problem.bias,
        problem.contacts,
        problem.unactuated,
        balance,
    )


def kept_by_contacts(jacobian: Array, contact_jacobian: Array) -> Array:
    """(m, d) task rows (m, n) in the accelerations that contact rows (q, n) leave."""
    (m, n), q = jacobian.shape, contact_jacobian.shape[0]
    nothing = ContactRows(
        contact_jacobian,
        np.zeros(q),
        np.zeros((0, n)),
        _NO_ROWS,
        _NONE,
        _NONE,
        _NONE,
        _NO_ROWS,
        (),
    )
    at_rest = np.zeros((n, n)), np.zeros(n)
    kept: Array = native.reduced(jacobian, np.zeros(m), *at_rest, nothing, 0, False)[0]
    return kept


def null_motion(rows: Array, target: Array) -> tuple[Array, Array]:
    """Least x (n,) with rows x = target, and an orthonormal basis (n, d) of rows x = 0.

    Rows (q, n) that depend on others are met in the least-squares sense.
    """
    _, least, basis = native.null_motion(rows, target)
    return least, basis

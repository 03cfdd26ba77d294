"""The control problem of one tick: tasks, priorities, dynamics and limits; no solver yet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.hierarchy.directions import Starts
from ghc_controller.types import Array, Bounds


@dataclass(frozen=True, slots=True)
class ContactRows:
    """Rigid contacts: J_c x = drift_target, with forces f acting through J_c^T.

    c = rows of all contacts, r = rows on their forces (friction cones, force bounds).
    """

    jacobian: Array  # (c, n)
    drift_target: Array  # (c,) = -dJ_c/dt v: the acceleration that keeps the contacts still
    force_matrix: Array  # (r, c)
    force_lower: Array  # (r,) [N]
    force_upper: Array  # (r,) [N]
    force_weight: float = 1e-4  # [-] on |f|^2, beside the unit weight of the tasks


@dataclass(frozen=True, slots=True)
class AccelerationRows:
    """General rows lower <= matrix x <= upper on the joint accelerations, such as obstacles."""

    matrix: Array  # (r, n)
    lower: Array  # (r,)
    upper: Array  # (r,)
    names: tuple[str, ...]  # (r,)


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """Everything that one formulation needs to find accelerations, contact forces and torques.

    n velocity coordinates, the first u of them unactuated, a = n - u joints, k tasks with m rows
    in total. Equation of motion (GHC paper, eq. 1): M x + h = [0; tau] + J_c^T f.
    """

    jacobian: Array  # (m, n) augmented Jacobian, eq. 10
    target: Array  # (m,) desired task accelerations minus drift
    starts: Starts  # (k + 1,) first row of each task
    alpha: Array  # (k, k) priority matrix
    mass_matrix: Array  # (n, n)
    bias: Array  # (n,) Coriolis, centrifugal and gravity
    acceleration: Bounds  # (n,) soft box on x: position and velocity limits
    torque: Bounds  # (a,) hard box on tau: torque limits and torque rate
    torque_limit: Bounds  # (a,) the torque limits alone, kept when the rate rows give way too
    rows: AccelerationRows | None = None  # soft rows
    contacts: ContactRows | None = None
    unactuated: int = 0

    def __post_init__(self) -> None:
        """Take a writable copy of a read-only alpha: kernels are compiled for one kind."""
        if not self.alpha.flags.writeable:
            object.__setattr__(self, "alpha", self.alpha.copy())

    def check(self) -> None:
        """Raise WrongSize or InvalidValue where the parts do not fit together."""
        m, n = self.jacobian.shape
        k = self.starts.shape[0] - 1
        joints = n - self.unactuated
        expected = {
            "target": (self.target.shape, (m,)),
            "alpha": (self.alpha.shape, (k, k)),
            "mass_matrix": (self.mass_matrix.shape, (n, n)),
            "bias": (self.bias.shape, (n,)),
            "acceleration bounds": (self.acceleration.lower.shape, (n,)),
            "torque bounds": (self.torque.lower.shape, (joints,)),
            "torque limits": (self.torque_limit.lower.shape, (joints,)),
        }
        for name, (given, wanted) in expected.items():
            if given != wanted:
                raise WrongSize(f"control problem: {name}", given, wanted)
        if self.starts[-1] != m:
            raise InvalidValue(f"starts end at row {self.starts[-1]}, the Jacobian has {m} rows")


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


def reduce_contacts(problem: ControlProblem, rank_tolerance: float = 1e-9) -> ReducedProblem:
    """Remove the accelerations that would break a contact (thesis, eq. 5.3).

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
    left, sigma, right = np.linalg.svd(contacts.jacobian, full_matrices=True)
    rank = int(np.sum(sigma > rank_tolerance * max(sigma[0], 1e-300))) if sigma.size else 0
    offset = right[:rank].T @ ((left[:, :rank].T @ contacts.drift_target) / sigma[:rank])
    basis = np.ascontiguousarray(right[rank:].T)
    torque_matrix = problem.mass_matrix @ basis
    torque_offset = problem.bias + problem.mass_matrix @ offset
    force = -contacts.jacobian.T
    return ReducedProblem(
        np.ascontiguousarray(problem.jacobian @ basis),
        problem.target - problem.jacobian @ offset,
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

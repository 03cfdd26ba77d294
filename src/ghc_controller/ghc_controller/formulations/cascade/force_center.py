"""Contact forces that a level asks for: those of least cost that carry its accelerations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import ReducedProblem, null_motion
from ghc_controller.problem.reduction_kernels import null_motion_qr
from ghc_controller.types import Array

_RANK_TOLERANCE = 1e-9  # [-] of the largest singular value of the balance force


class ForceCenter(NamedTuple):
    """f*(y) = f_0 + F s, s the least one that balances the base at accelerations y.

    Of a fixed base f* = f_0.
    """

    center: Array  # (c,) f_0
    gain: Array  # (c, u) F A^+ with A = balance_force F, F F^T = H_f^-1; u = 0 on a fixed base
    free: Array  # (c, c - rank) F N, A N = 0: forces that leave the base alone
    residual: Array  # (u,) what is left to balance at y = 0 and f_0

    def at(self, reduced: ReducedProblem, y: Array) -> Array:
        """Forces (c,) at accelerations (d,)."""
        if self.residual.shape[0] == 0:
            return self.center
        force: Array = self.center + self.gain @ (self.residual - reduced.balance_matrix @ y)
        return force

    def parametrization(
        self, reduced: ReducedProblem, y: Array, factor: Array, weight: float
    ) -> Parametrization:
        """Accelerations y + factor s and the forces f* of each, plus what leaves the base alone.

        Cost 1/2 |s|^2: factor (d, p) whitens the accelerations, `weight` is the root of that on
        the forces. The balance holds for every s.
        """
        d, p = factor.shape
        c, q = self.free.shape
        accelerations, forces = np.zeros((d, p + q)), np.zeros((c, p + q))
        accelerations[:, :p] = factor
        forces[:, p:] = self.free / weight
        if self.residual.shape[0]:
            forces[:, :p] = -self.gain @ (reduced.balance_matrix @ factor)
        return Parametrization(y, accelerations, self.at(reduced, y), forces, True)


def balanced_contacts(reduced: ReducedProblem) -> tuple[ReducedProblem, ForceCenter]:
    """The problem in accelerations that contact forces can balance, and the forces for them.

    In flight, or with contacts too few to carry every direction, N^T M_u y = N^T rhs with N the
    left null space of the balance force is level 0: what remains of y are motions that conserve
    momentum along N.
    """
    contacts, u = reduced.source.contacts, reduced.source.unactuated
    c = reduced.torque_force.shape[1]
    center = np.zeros(c) if contacts is None else contacts.force_center
    factor = np.zeros((0, 0)) if contacts is None else contacts.force_factor
    if u == 0:
        return reduced, ForceCenter(center, np.zeros((c, 0)), factor, np.zeros(0))
    whitened = reduced.balance_force @ factor
    independent, free = False, np.zeros((0, 0))
    if c >= u:
        independent, _, free = null_motion_qr(whitened, np.zeros(u))
    if independent:
        inverse = np.linalg.solve(whitened @ whitened.T, whitened).T
    else:
        left, sigma, right = np.linalg.svd(whitened, full_matrices=True)
        largest = float(sigma[0]) if sigma.size else 0.0
        rank = int(np.sum(sigma > _RANK_TOLERANCE * largest))
        inverse, free = right[:rank].T / sigma[:rank], right[rank:].T
        reduced = _without(reduced, left[:, rank:].T, left[:, :rank].T)
    residual = reduced.balance_target - reduced.balance_force @ center
    return reduced, ForceCenter(center, factor @ inverse, factor @ free, residual)


def _without(reduced: ReducedProblem, uncarried: Array, carried: Array) -> ReducedProblem:
    """Reduce y by uncarried M_u y = uncarried rhs; keep the balance along `carried` rows."""
    offset, basis = null_motion(
        uncarried @ reduced.balance_matrix, uncarried @ reduced.balance_target
    )
    whole = np.eye(basis.shape[0]) if reduced.basis is None else reduced.basis
    return reduced._replace(
        jacobian=np.ascontiguousarray(reduced.jacobian @ basis),
        target=reduced.target - reduced.jacobian @ offset,
        basis=np.ascontiguousarray(whole @ basis),
        offset=reduced.accelerations(offset),
        torque_matrix=np.ascontiguousarray(reduced.torque_matrix @ basis),
        torque_offset=reduced.torque_offset + reduced.torque_matrix @ offset,
        balance_matrix=carried @ reduced.balance_matrix @ basis,
        balance_force=carried @ reduced.balance_force,
        balance_target=carried @ (reduced.balance_target - reduced.balance_matrix @ offset),
    )

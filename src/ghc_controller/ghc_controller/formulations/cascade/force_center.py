"""Contact forces of a level: minimum-cost forces for its accelerations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.qp_rows import Parametrization
from ghc_controller.problem.reduction import ReducedProblem, reduce_contacts, reduced_arrays
from ghc_controller.types import Array

_NONE, _NO_FORCES = np.zeros(0), np.zeros((0, 0))


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


def balanced_contacts(problem: ControlProblem) -> tuple[ReducedProblem, ForceCenter]:
    """The problem in accelerations that contact forces can balance, and the forces for them.

    In flight, or with contacts too few to carry every direction, N^T M_u y = N^T rhs with N the
    left null space of the balance force is level 0: what remains of y are motions that conserve
    momentum along N.
    """
    if problem.unactuated > 0:
        return of_arrays(problem, reduced_arrays(problem, balance=True))
    reduced, contacts = reduce_contacts(problem), problem.contacts
    if contacts is None:
        return reduced, ForceCenter(_NONE, _NO_FORCES, _NO_FORCES, _NONE)
    center, factor = contacts.force_center, contacts.force_factor
    return reduced, ForceCenter(center, np.zeros((center.shape[0], 0)), factor, _NONE)


def of_arrays(
    problem: ControlProblem, arrays: Sequence[Any]
) -> tuple[ReducedProblem, ForceCenter]:
    """Reduced problem and forces of the arrays that `reduced_arrays` names."""
    return ReducedProblem._make((*arrays[:10], problem)), ForceCenter(*arrays[10:])

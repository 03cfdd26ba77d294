"""What the compiled core takes of a problem, in its order (core/native.pyi)."""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations.cascade.force_center import ForceCenter
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.types import Array

_EMPTY = np.zeros((0, 0))
_NONE = np.zeros(0)


def core_terms(reduced: ReducedProblem, forces: ForceCenter) -> tuple[Array, ...]:
    """Motion, forces and balance, rows, and bounds, those of accelerations and torques first."""
    source = reduced.source
    contacts, general = source.contacts, source.rows
    return (
        _EMPTY if reduced.basis is None else reduced.basis,
        _NONE if reduced.offset is None else reduced.offset,
        reduced.torque_matrix,
        reduced.torque_offset,
        reduced.torque_force,
        forces.center,
        forces.gain,
        forces.free,
        forces.residual,
        reduced.balance_matrix,
        reduced.balance_force,
        _EMPTY if general is None else general.matrix,
        _EMPTY if contacts is None else contacts.force_matrix,
        source.acceleration.lower,
        source.acceleration.upper,
        source.torque.lower,
        source.torque.upper,
        *((_NONE, _NONE) if general is None else (general.lower, general.upper)),
        *((_NONE, _NONE) if contacts is None else (contacts.force_lower, contacts.force_upper)),
    )

"""What the compiled core takes of a problem, in its order (core/native.pyi)."""

from __future__ import annotations

from ghc_controller.formulations.cascade.force_center import ForceCenter
from ghc_controller.problem.control_problem import ContactRows
from ghc_controller.problem.reduction import ReducedProblem
from ghc_controller.types import Array

_NO_FORCES = (None,) * 7


def core_terms(reduced: ReducedProblem, forces: ForceCenter) -> tuple[Array | None, ...]:
    """Motion, forces and balance, rows, and bounds; None stands for what the problem has not."""
    source = reduced.source
    contacts, general = source.contacts, source.rows
    acceleration, torque = source.acceleration, source.torque
    floats = source.unactuated > 0
    return (
        reduced.basis,
        reduced.offset,
        reduced.torque_matrix,
        reduced.torque_offset,
        *(_force_terms(reduced, forces) if floats or contacts is not None else _NO_FORCES),
        None if general is None else general.matrix,
        None if contacts is None else contacts.force_matrix,
        acceleration.lower,
        acceleration.upper,
        torque.lower,
        torque.upper,
        None if general is None else general.lower,
        None if general is None else general.upper,
        *_force_bounds(contacts),
    )


def _force_terms(reduced: ReducedProblem, forces: ForceCenter) -> tuple[Array | None, ...]:
    return (
        reduced.torque_force,
        forces.center,
        forces.gain,
        forces.free,
        forces.residual,
        reduced.balance_matrix,
        reduced.balance_force,
    )


def _force_bounds(contacts: ContactRows | None) -> tuple[Array | None, Array | None]:
    return (None, None) if contacts is None else (contacts.force_lower, contacts.force_upper)

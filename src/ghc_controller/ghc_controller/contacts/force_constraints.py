"""Normal forces and friction of the contacts that are on, as constraints on their forces."""

from __future__ import annotations

from ghc_controller.constraints.constraint import Constraint, Rows, Softness, Space, Tick
from ghc_controller.contacts.contact_set import ContactSet


class NormalForce(Constraint):
    """F_lower <= F_n <= F_upper of each contact (thesis, eq. 5.5); relaxed after all others.

    The bounds are those that `ContactSet.rows` was given: of robot.yaml, or of a generator.
    """

    space = Space.FORCE
    softness = Softness.FORCE

    def __init__(self, contacts: ContactSet, name: str = "normal_force") -> None:
        """Bound the contacts of this set."""
        super().__init__(name)
        self._contacts = contacts

    def rows(self, tick: Tick) -> Rows | None:  # noqa: ARG002
        """A row for each contact that is on."""
        return self._contacts.normal_rows()


class FrictionCone(Constraint):
    """What each contact's kind says of its forces, such as a pyramid (thesis, eq. 5.3)."""

    space = Space.FORCE
    softness = Softness.HARD

    def __init__(self, contacts: ContactSet, name: str = "friction") -> None:
        """Bound the contacts of this set."""
        super().__init__(name)
        self._contacts = contacts

    def rows(self, tick: Tick) -> Rows | None:  # noqa: ARG002
        """Rows of all contacts that are on."""
        return self._contacts.cone_rows()

"""Normal force bounds and friction of the active contacts, as constraints on their forces."""

from __future__ import annotations

from ghc_controller.constraints.constraint import Constraint, Rows, Softness, Space, Tick
from ghc_controller.contacts.contact_set import ContactSet


class NormalForce(Constraint):
    """F_lower <= F_n <= F_upper of each contact (thesis, eq. 5.5); relaxed last.

    The bounds are those passed to `ContactSet.rows`: of robot.yaml, or of a generator.
    """

    space = Space.FORCE
    softness = Softness.FORCE

    def __init__(self, contacts: ContactSet, name: str = "normal_force") -> None:
        """Bound the contacts of this set."""
        super().__init__(name)
        self._contacts = contacts

    @property
    def is_idle(self) -> bool:
        """Whether no contact is on."""
        return self._contacts.none_on

    def rows(self, tick: Tick) -> Rows | None:  # noqa: ARG002
        """One row per active contact."""
        return self._contacts.normal_rows()


class FrictionCone(Constraint):
    """The force constraints of each contact kind, such as a friction pyramid (thesis, eq. 5.3)."""

    space = Space.FORCE
    softness = Softness.HARD

    def __init__(self, contacts: ContactSet, name: str = "friction") -> None:
        """Bound the contacts of this set."""
        super().__init__(name)
        self._contacts = contacts

    @property
    def is_idle(self) -> bool:
        """Whether no contact is on."""
        return self._contacts.none_on

    def rows(self, tick: Tick) -> Rows | None:  # noqa: ARG002
        """Rows of all active contacts."""
        return self._contacts.cone_rows()

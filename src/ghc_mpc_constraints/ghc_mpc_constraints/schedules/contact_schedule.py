"""Piecewise constant bounds on the normal force of a contact over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule


@dataclass(frozen=True, slots=True, eq=False)
class ContactSchedule(LimitSchedule):
    """Smallest and largest normal force [N], >= 0, of one contact; constructed by `checked`."""

    THING: ClassVar[str] = "contact"
    SMALLEST: ClassVar[float] = 0.0
    WHY: ClassVar[str] = " N given, 0 or more expected: a contact pushes"

    @property
    def contact(self) -> str:
        """Name of the contact."""
        return self.name

    @classmethod
    def read(
        cls, message: Any, start: float, known: Sequence[str] = ()
    ) -> tuple[ContactSchedule, ...]:
        """Schedule of a ghc_msgs/ContactSchedule whose times count from `start` [s].

        Raises:
            GhcError: as `checked`.
        """
        times = start + np.array(message.times, dtype=np.float64)
        lower, upper = list(message.lower), list(message.upper)
        return (cls.checked(message.contact, times.tolist(), lower, upper, known),)

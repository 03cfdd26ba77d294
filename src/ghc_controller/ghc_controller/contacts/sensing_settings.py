"""Settings of contact detection."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import NOT_NEGATIVE, Range

_NOT_ZERO = Range(minimum=1e-3)


@dataclass(frozen=True, slots=True)
class Sensing:
    """The section `sensing` of a contact in robot.yaml."""

    threshold: float = declared(
        "measured normal force at which the contact counts as detected",
        5.0,
        unit="N",
        domain=_NOT_ZERO,
    )
    rise_rate: float = declared(
        "of the upper bound after a late touch-down", 200.0, unit="N/s", domain=_NOT_ZERO
    )
    early: float = declared(
        "before its scheduled time that a touch-down is accepted",
        0.5,
        unit="s",
        domain=NOT_NEGATIVE,
    )
    patience: float = declared(
        "that a scheduled lift-off waits for the force to vanish",
        0.2,
        unit="s",
        domain=NOT_NEGATIVE,
    )

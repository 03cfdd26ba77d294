"""Numbers by which a contact is sensed."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.reader import Fields


@dataclass(frozen=True, slots=True)
class Sensing:
    """Numbers by which one contact is sensed; all positive."""

    threshold: float = 5.0  # [N] measured normal force from which on it counts as touched
    rise_rate: float = 200.0  # [N/s] of the upper bound after a touch that came late
    early: float = 0.5  # [s] before its scheduled time a touch is believed
    patience: float = 0.2  # [s] that a scheduled break waits for the force to go

    @classmethod
    def from_config(cls, fields: Fields) -> Sensing:
        """Build from the `sensing` section of a contact in robot.yaml."""
        default = cls()
        sensing = cls(
            fields.number("threshold", default.threshold, minimum=1e-3),
            fields.number("rise_rate", default.rise_rate, minimum=1e-3),
            fields.number("early", default.early, minimum=0.0),
            fields.number("patience", default.patience, minimum=0.0),
        )
        fields.done()
        return sensing

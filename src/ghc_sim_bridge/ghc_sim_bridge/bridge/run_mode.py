"""When a control period happens: at the answer of the controller, or by the wall clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ghc_controller.safety.torque_gate import GatedTorque
from ghc_controller.types import Array

Outcome = Callable[[GatedTorque], None]  # told of every command that was applied


class RunMode(Protocol):
    """What the node tells a mode, and what it may ask."""

    paused: bool
    tick_period: float  # [s] wall
    waits: bool  # whether time stands still until a command is used

    def command(self, stamp_ns: int, torque: Array) -> str:
        """Use a checked command (n,) [Nm] that answers the state of `stamp_ns` [ns].

        Returns the reason why it was not wanted, a word to count by, or "" when it was used.
        """

    def tick(self) -> None:
        """Time passed: repeat, pace, hold, or raise PartnerMissing."""

    def restart(self) -> None:
        """The state was reset, or the pause ended: publish it and go on from there."""

    def diagnostics(self) -> dict[str, object]:
        """Figures of this mode for /diagnostics."""

"""Interface of run modes: a control period runs at the controller's answer, or by the wall
clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ghc_controller.safety.torque_gate import GatedTorque
from ghc_controller.types import Array

Outcome = Callable[[GatedTorque], None]  # called for every applied command


class RunMode(Protocol):
    """Interface between the node and a run mode."""

    paused: bool
    tick_period: float  # [s] wall
    waits: bool  # whether simulated time stops until a command is used

    def command(self, stamp_ns: int, torque: Array) -> str:
        """Use a checked command (n,) [Nm] that answers the state of `stamp_ns` [ns].

        Returns the reason for a rejection, a word to count by, or "" when it was used.
        """

    def tick(self) -> None:
        """Time passed: repeat, pace, hold, or raise PartnerMissing."""

    def restart(self) -> None:
        """The state was reset, or the pause ended: publish it and continue from there."""

    def diagnostics(self) -> dict[str, object]:
        """Figures of this mode for /diagnostics."""

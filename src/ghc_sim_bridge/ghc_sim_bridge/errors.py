"""Errors of the simulator side."""

from __future__ import annotations

from ghc_controller.errors import GhcError


class SimulationDiverged(GhcError):
    """The simulated robot left the range in which its numbers mean anything; names the joint."""

    def __init__(self, joint: str, quantity: str, value: float, unit: str, time: float) -> None:
        self.joint = joint
        self.value = value
        self.time = time
        super().__init__(
            f"the simulation diverged at t = {time:.6f} s: {quantity} of {joint} is "
            f"{value:.3g} {unit}; is the commanded torque right, and physics_dt small enough?"
        )


class RenderingUnavailable(GhcError):
    """No off-screen OpenGL on this machine; says what was tried and what to install."""

"""Controller modes: when it moves the robot, holds it, or brakes."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

RESET = "controller/reset_fault"
ARM = "controller/arm"


class Mode(Enum):
    """What the controller does with the robot; the values of ghc_msgs/ControllerMode."""

    WAITING = 0  # no valid state received yet: no commands are sent
    HOLDING = 1  # the robot is kept where it is
    ACTIVE = 2  # references and hierarchy are followed
    LATCHED = 3  # a fault: braked until it is reset


class Arming(Enum):
    """What makes a controller active."""

    REQUEST = "request"  # the first transition or reference that it accepts, or the service
    EXPLICIT = "explicit"  # only the service; earlier requests are rejected
    AUTOMATIC = "automatic"  # the first state: for simulations; faults are not latched


class ModeLogic:
    """State machine of the modes, with reasons.

    waiting -> holding (first state) -> active (armed) -> latched (fault) -> holding (reset).
    With Arming.AUTOMATIC: waiting -> active. A run that cannot begin at the robot's position
    returns to waiting, unless a fault is latched.
    """

    def __init__(self, arming: Arming, changed: Callable[[], None]) -> None:
        """Begin in WAITING; `changed` is called on every change after that."""
        self.arming = arming
        self._changed = changed
        self.mode, self.reason = Mode.WAITING, "no joint_states yet"

    @property
    def latches(self) -> bool:
        """Whether a fault is latched."""
        return self.arming is not Arming.AUTOMATIC

    def started(self) -> None:
        """The first state of a run is about to be answered."""
        if self.mode is Mode.LATCHED:
            return
        if self.arming is Arming.AUTOMATIC:
            self._set(Mode.ACTIVE, "arming is automatic")
        else:
            self._set(Mode.HOLDING, f"started where the robot is; {self._way_on}")

    def waits(self, reason: str) -> None:
        """A run cannot begin in the current robot state."""
        if self.mode is not Mode.LATCHED and (self.mode, self.reason) != (Mode.WAITING, reason):
            self._set(Mode.WAITING, reason)

    def refusal(self) -> str:
        """Why requests are rejected now; "" if they are accepted."""
        if self.mode is Mode.LATCHED:
            return f"the controller is latched ({self.reason})"
        if self.mode is Mode.WAITING:
            return f"the controller is waiting ({self.reason})"
        if self.mode is Mode.HOLDING and self.arming is Arming.EXPLICIT:
            return f"the controller is holding the robot; {self._way_on}"
        return ""

    def requested(self) -> None:
        """A request was accepted."""
        if self.mode is Mode.HOLDING and self.arming is not Arming.EXPLICIT:
            self._set(Mode.ACTIVE, "a request was accepted")

    def arm(self) -> str:
        """Become active; returns why not, "" on success."""
        if self.mode is Mode.HOLDING:
            self._set(Mode.ACTIVE, f"armed by {ARM}")
        return "" if self.mode is Mode.ACTIVE else f"{self.mode.name}: {self.reason}"

    def hold(self) -> str:
        """Hold the robot; returns why not, "" on success."""
        if self.mode is Mode.ACTIVE:
            self._set(Mode.HOLDING, f"asked to hold; {self._way_on}")
        return "" if self.mode is Mode.HOLDING else f"{self.mode.name}: {self.reason}"

    def fault(self, reason: str) -> None:
        """Brake until reset; the first reason stays."""
        if self.latches and self.mode is not Mode.LATCHED:
            self._set(Mode.LATCHED, f"{reason}; call {RESET} when its cause is gone")

    def reset_fault(self) -> str:
        """Change from LATCHED to HOLDING; returns why not, "" on success."""
        if self.mode is not Mode.LATCHED:
            return f"{self.mode.name}: there is no fault"
        self._set(Mode.HOLDING, f"fault reset; {self._way_on}")
        return ""

    @property
    def _way_on(self) -> str:
        if self.arming is Arming.EXPLICIT:
            return f"call {ARM} to go on"
        return f"the first accepted request, or {ARM}, makes it active"

    def _set(self, mode: Mode, reason: str) -> None:
        self.mode, self.reason = mode, reason
        self._changed()

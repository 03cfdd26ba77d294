"""Which state waits for its answer, when to repeat it, and when to give up."""

from __future__ import annotations

from enum import Enum

from ghc_controller.errors import GhcError

REPEAT_PERIOD = 0.05  # [s] wall; a state not answered by then was lost on the way, or its answer


class PartnerMissing(GhcError):
    """No command answered the state within the deadline; says which and how long."""


class Due(Enum):
    """What the loop has to do now."""

    NOTHING = 0
    REPEAT = 1  # publish the same state again: the controller answers it with the same command
    GIVE_UP = 2


class Lockstep:
    """Times on any monotonic clock in seconds; stamps of simulated time in nanoseconds."""

    def __init__(self, timeout: float, now: float) -> None:
        """Give up on a state after `timeout` [s]; waiting starts at `now` [s]."""
        self._timeout = timeout
        self._waiting_since = now
        self._sent_at = now
        self.awaited_ns = 0
        self.repeats = 0

    def sent(self, stamp_ns: int, now: float) -> None:
        """A new state was published: only the command with this stamp moves the robot."""
        self.awaited_ns = stamp_ns
        self._waiting_since = now
        self._sent_at = now

    def repeated(self, now: float) -> None:
        """The awaited state was published once more."""
        self._sent_at = now
        self.repeats += 1

    def keep_waiting(self, now: float) -> None:
        """Nobody is late (paused, or the run has ended): start the deadline anew."""
        self._waiting_since = now

    def due(self, now: float) -> Due:
        """What to do at `now` [s]."""
        if now - self._waiting_since > self._timeout:
            return Due.GIVE_UP
        if now - self._sent_at >= REPEAT_PERIOD:
            return Due.REPEAT
        return Due.NOTHING

    def missing(self, topic: str, epoch: int, now: float, last_rejection: str) -> PartnerMissing:
        """Error that names the partner, the state and, where known, why answers were refused."""
        waited = now - self._waiting_since
        because = (
            f"; the last one was refused: {last_rejection}"
            if last_rejection
            else "; is the controller running, with this robot and in this ROS domain?"
        )
        return PartnerMissing(
            f"no command on '{topic}' answered the state of t = {self.awaited_ns * 1e-9:.6f} s "
            f"(epoch {epoch}) within {waited:.1f} s{because}"
        )

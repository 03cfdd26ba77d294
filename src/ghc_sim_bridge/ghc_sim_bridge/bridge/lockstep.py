"""Lockstep: state k+1 exists only after the command for state k."""

from __future__ import annotations

import time
from collections.abc import Callable
from enum import Enum

from ghc_controller.errors import GhcError
from ghc_controller.types import Array
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.run_mode import Outcome

REPEAT_PERIOD = 0.05  # [s] wall; after this time the state or its answer was lost
TICK_PERIOD = 0.01  # [s] wall; period of checks for repeats and the deadline


class PartnerMissing(GhcError):
    """No command answered the state within the deadline."""


class Due(Enum):
    """Next action of the loop."""

    NOTHING = 0
    REPEAT = 1  # publish the same state again: the controller answers it with the same command
    GIVE_UP = 2


class Lockstep:
    """Times on any monotonic clock in seconds; stamps of simulated time in nanoseconds."""

    def __init__(self, timeout: float, now: float) -> None:
        """Stop waiting for an answer after `timeout` [s]; waiting starts at `now` [s]."""
        self._timeout = timeout
        self._waiting_since = now
        self._sent_at = now
        self.awaited_ns = 0
        self.repeats = 0

    def sent(self, stamp_ns: int, now: float) -> None:
        """Register a new published state: only the command with this stamp advances time."""
        self.awaited_ns = stamp_ns
        self._waiting_since = now
        self._sent_at = now

    def repeated(self, now: float) -> None:
        """Register that the awaited state was published again."""
        self._sent_at = now
        self.repeats += 1

    def keep_waiting(self, now: float) -> None:
        """No answer is due (paused, or the run has ended): restart the deadline."""
        self._waiting_since = now

    def due(self, now: float) -> Due:
        """Action at `now` [s]."""
        if now - self._waiting_since > self._timeout:
            return Due.GIVE_UP
        if now - self._sent_at >= REPEAT_PERIOD:
            return Due.REPEAT
        return Due.NOTHING

    def missing(self, topic: str, epoch: int, now: float, last_rejection: str) -> PartnerMissing:
        """Error that names the partner, the state and, if known, why answers were rejected."""
        waited = now - self._waiting_since
        because = (
            f"; the last one was rejected: {last_rejection}"
            if last_rejection
            else "; is the controller running, with this robot and in this ROS domain?"
        )
        return PartnerMissing(
            f"no command on '{topic}' answered the state of t = {self.awaited_ns * 1e-9:.6f} s "
            f"(epoch {epoch}) within {waited:.1f} s{because}"
        )


class LockstepMode:
    """Same inputs, same trajectory, on any machine and as fast as possible."""

    waits = True

    def __init__(
        self,
        cycle: ControlCycle,
        publish: Callable[[], None],
        applied: Outcome,
        timeout: float,
        stop_ns: int,
        explain: Callable[[], str],
    ) -> None:
        """`explain` returns the reason for the last rejected command, "" if there is none."""
        self.paused = False
        self.tick_period = TICK_PERIOD
        self._cycle = cycle
        self._publish = publish
        self._applied = applied
        self._stop_ns = stop_ns
        self._explain = explain
        self._lockstep = Lockstep(timeout, time.monotonic())

    @property
    def _waiting(self) -> bool:
        return not self.paused and self._cycle.run_ns < self._stop_ns

    def command(self, stamp_ns: int, torque: Array) -> str:
        """Simulate the period and publish the next state, if this answers the awaited one."""
        if not self._waiting:
            return "not_running"
        if stamp_ns < self._lockstep.awaited_ns:
            return "answered_before"  # a repeated state is answered twice
        if stamp_ns > self._lockstep.awaited_ns:
            return "stamp_of_no_state"
        gated = self._cycle.advance(torque)
        self._publish()
        self._lockstep.sent(self._cycle.time_ns, time.monotonic())
        self._applied(gated)
        return ""

    def tick(self) -> None:
        """Repeat an unanswered state.

        Raises:
            PartnerMissing: no answer within the deadline.
        """
        now = time.monotonic()
        if not self._waiting:
            self._lockstep.keep_waiting(now)
        due = self._lockstep.due(now)
        if due is Due.GIVE_UP:
            raise self._lockstep.missing("joint_commands", self._cycle.epoch, now, self._explain())
        if due is Due.REPEAT:
            self._publish()
            self._lockstep.repeated(now)

    def diagnostics(self) -> dict[str, object]:
        """Repeats since the start: nonzero on a lossy link or with a slow controller."""
        return {"repeats": self._lockstep.repeats}

    def restart(self) -> None:
        """Publish the current state and wait for its answer."""
        self._publish()
        self._lockstep.sent(self._cycle.time_ns, time.monotonic())

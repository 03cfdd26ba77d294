"""Decides in realtime mode whether commands or the hold torque drive the robot."""

from __future__ import annotations

FRESH_COMMANDS_TO_RESUME = 3  # [-] one command may be the last gasp of a dying controller


class Watchdog:
    """Holds until fresh commands arrive in a row, and again after a silence.

    The age of a command is simulated time now minus the stamp of the state that it answers, so a
    bridge that was itself not scheduled for a while does not take that for silence.
    """

    def __init__(self, timeout_ns: int) -> None:
        """A command older than `timeout_ns` [ns] does not count."""
        self._timeout_ns = timeout_ns
        self._last_stamp_ns: int | None = None
        self._fresh_in_a_row = 0
        self.holding = True

    def reset(self) -> None:
        """Forget every command: simulated time starts anew."""
        self._last_stamp_ns = None
        self._fresh_in_a_row = 0
        self.holding = True

    def refuses(self, stamp_ns: int, now_ns: int) -> str:
        """Why a command for the state of `stamp_ns` does not count at `now_ns`; "" if it does."""
        if stamp_ns > now_ns:
            return "stamp_of_no_state"
        if now_ns - stamp_ns > self._timeout_ns:
            return "stale"
        if self._last_stamp_ns is not None and stamp_ns <= self._last_stamp_ns:
            return "answered_before"  # a repeat, or overtaken: the newer command stays in force
        return ""

    def accept(self, stamp_ns: int) -> None:
        """Note a command that `refuses` had nothing against."""
        self._last_stamp_ns = stamp_ns
        self._fresh_in_a_row += 1
        if self._fresh_in_a_row >= FRESH_COMMANDS_TO_RESUME:
            self.holding = False

    def check(self, now_ns: int) -> bool:
        """True when the robot has to be held at `now_ns` [ns]."""
        if self._last_stamp_ns is None or now_ns - self._last_stamp_ns > self._timeout_ns:
            self._fresh_in_a_row = 0
            self.holding = True
        return self.holding

"""Realtime: periods by the wall clock, with a hold torque when commands time out."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_controller.types import Array
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.lockstep import REPEAT_PERIOD
from ghc_sim_bridge.bridge.run_mode import Outcome

MAX_CATCH_UP = 5  # [-] periods simulated at once after a delay; the rest is dropped: time slips
FRESH_COMMANDS_TO_RESUME = 3  # [-] a single late command must not re-enable the robot


class Pacer:
    """Keeps simulated time on the wall clock without bursts after a long delay."""

    def __init__(self, period: float, now: float) -> None:
        """Periods of `period` [s] counted from `now` [s]."""
        self._period = period
        self._next = now + period
        self.overruns = 0  # [-] periods dropped since the start

    def restart(self, now: float) -> None:
        """Count from `now` [s]: after a pause or a reset."""
        self._next = now + self._period

    def due(self, now: float) -> int:
        """Periods to simulate at `now` [s], at most MAX_CATCH_UP."""
        if now < self._next:
            return 0
        late = int((now - self._next) / self._period) + 1
        self._next += late * self._period
        self.overruns += max(0, late - MAX_CATCH_UP)
        return min(late, MAX_CATCH_UP)


class Watchdog:
    """Holds until consecutive fresh commands arrive, and again after a timeout.

    The age of a command is simulated time now minus the stamp of the state that it answers, so a
    bridge that was not scheduled for a while does not mistake that for a timeout.
    """

    def __init__(self, timeout_ns: int) -> None:
        """A command older than `timeout_ns` [ns] is not used."""
        self._timeout_ns = timeout_ns
        self._last_stamp_ns: int | None = None
        self._fresh_in_a_row = 0
        self.holding = True

    def reset(self) -> None:
        """Discard every command: simulated time restarts."""
        self._last_stamp_ns = None
        self._fresh_in_a_row = 0
        self.holding = True

    def refuses(self, stamp_ns: int, now_ns: int) -> str:
        """Why a command for the state of `stamp_ns` is rejected at `now_ns`; "" if accepted."""
        if stamp_ns > now_ns:
            return "stamp_of_no_state"
        if now_ns - stamp_ns > self._timeout_ns:
            return "stale"
        if self._last_stamp_ns is not None and stamp_ns <= self._last_stamp_ns:
            return "answered_before"  # a repeat, or overtaken: the newer command stays active
        return ""

    def accept(self, stamp_ns: int) -> None:
        """Register a command that `refuses` accepted."""
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


class RealtimeMode:
    """Periods by the wall clock; the last command stays active while it is fresh."""

    waits = False

    def __init__(
        self,
        cycle: ControlCycle,
        publish: Callable[[], None],
        applied: Outcome,
        watchdog: Watchdog,
        stop_ns: int,
    ) -> None:
        """Start holding: commands drive the robot after a few consecutive fresh ones."""
        self.paused = False
        self.tick_period = cycle.period_ns * 1e-9
        self.watchdog = watchdog
        self._cycle = cycle
        self._publish = publish
        self._applied = applied
        self._stop_ns = stop_ns
        self._pacer = Pacer(self.tick_period, time.monotonic())
        self._sent_at = 0.0
        self._torque: Array | None = None

    def diagnostics(self) -> dict[str, object]:
        """Whether the robot is held, and periods that were dropped."""
        return {"holding": self.watchdog.holding, "dropped_periods": self._pacer.overruns}

    def command(self, stamp_ns: int, torque: Array) -> str:
        """Use the command for the next periods if it answers a recent state."""
        refused = self.watchdog.refuses(stamp_ns, self._cycle.time_ns)
        if not refused:
            self.watchdog.accept(stamp_ns)
            self._torque = torque
        return refused

    def tick(self) -> None:
        """Simulate the periods due by the wall clock."""
        now = time.monotonic()
        if self.paused or self._cycle.run_ns >= self._stop_ns:
            self._pacer.restart(now)
            if now - self._sent_at >= REPEAT_PERIOD:
                self._send(now)
            return
        for _ in range(self._pacer.due(now)):
            holding = self.watchdog.check(self._cycle.time_ns)
            gated = self._cycle.advance(None if holding else self._torque)
            self._send(now)
            if not holding:
                self._applied(gated)
            if self._cycle.run_ns >= self._stop_ns:
                break

    def _send(self, now: float) -> None:
        self._publish()
        self._sent_at = now

    def restart(self) -> None:
        """Publish the current state; hold until commands for it arrive."""
        now = time.monotonic()
        self.watchdog.reset()
        self._pacer.restart(now)
        self._send(now)

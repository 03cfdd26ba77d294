"""Periods by the wall clock, with a hold torque where commands fall silent."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_controller.types import Array
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.lockstep import REPEAT_PERIOD
from ghc_sim_bridge.bridge.pacing import Pacer
from ghc_sim_bridge.bridge.run_mode import Outcome
from ghc_sim_bridge.bridge.watchdog import Watchdog


class RealtimeMode:
    """Periods by the wall clock; the last command stays in force while it is fresh."""

    def __init__(
        self,
        cycle: ControlCycle,
        publish: Callable[[], None],
        applied: Outcome,
        watchdog: Watchdog,
        stop_ns: int,
    ) -> None:
        """Start holding: commands drive the robot after a few fresh ones in a row."""
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
        """Whether the robot is held, and periods that the machine was too late for."""
        return {"holding": self.watchdog.holding, "dropped_periods": self._pacer.overruns}

    def command(self, stamp_ns: int, torque: Array) -> str:
        """Keep the command for the periods to come, if it answers a recent state."""
        refused = self.watchdog.refuses(stamp_ns, self._cycle.time_ns)
        if not refused:
            self.watchdog.accept(stamp_ns)
            self._torque = torque
        return refused

    def tick(self) -> None:
        """Simulate the periods that the wall clock asks for."""
        now = time.monotonic()
        if self.paused or self._cycle.time_ns >= self._stop_ns:
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
            if self._cycle.time_ns >= self._stop_ns:
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

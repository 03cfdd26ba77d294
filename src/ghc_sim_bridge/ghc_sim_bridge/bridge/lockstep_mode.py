"""State k+1 exists only after the command for state k."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_controller.types import Array
from ghc_sim_bridge.bridge.cycle import ControlCycle
from ghc_sim_bridge.bridge.lockstep import Due, Lockstep
from ghc_sim_bridge.bridge.run_mode import Outcome

TICK_PERIOD = 0.01  # [s] wall; how often repeats and the deadline are looked at


class LockstepMode:
    """Same inputs, same trajectory, on any machine and as fast as it can."""

    def __init__(
        self,
        cycle: ControlCycle,
        publish: Callable[[], None],
        applied: Outcome,
        timeout: float,
        stop_ns: int,
        explain: Callable[[], str],
    ) -> None:
        """`explain` gives the reason of the last refused command, "" when there was none."""
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
        return not self.paused and self._cycle.time_ns < self._stop_ns

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
            PartnerMissing: nobody answered within the deadline.
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
        """Repeats since the start: not zero on a lossy link or with a slow controller."""
        return {"repeats": self._lockstep.repeats}

    def restart(self) -> None:
        """Publish the current state and wait for its answer."""
        self._publish()
        self._lockstep.sent(self._cycle.time_ns, time.monotonic())

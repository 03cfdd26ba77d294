"""Queues messages that arrive before the run to which they belong."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from ghc_mpc_constraints.ros.tick_clock import TickClock

MOST_EARLY = 1000  # [-] messages that wait for the first tick or the next run: the newest


class EarlyMessages:
    """Deferred calls: at the first tick, and at the first tick of the next run."""

    def __init__(self, clock: TickClock) -> None:
        """`clock` provides the time and the current run."""
        self._clock = clock
        self._first_tick: deque[Callable[[], None]] = deque(maxlen=MOST_EARLY)
        self._next_run: deque[Callable[[], None]] = deque(maxlen=MOST_EARLY)

    def after_first_tick(self, handle: Callable[[], None], newest_only: bool = False) -> None:
        """Call it now, or at the first tick, when the robot's time is known."""
        if self._clock.now_ns < 0:
            if newest_only:
                self._first_tick.clear()
            self._first_tick.append(handle)
        else:
            handle()

    def wait_for_run_of(self, stamp_ns: int, handle: Callable[[], None]) -> bool:
        """Whether a stamp [ns] belongs to a run that has not begun; then the call is deferred."""
        if not self._clock.timeline.is_of_next_run(stamp_ns):
            return False
        self._next_run.append(handle)
        return True

    def begin_run(self) -> None:
        """Make the calls deferred to this run."""
        _do_all(self._next_run)

    def begin_ticks(self) -> None:
        """Make the calls deferred to the first tick."""
        _do_all(self._first_tick)


def _do_all(waiting: deque[Callable[[], None]]) -> None:
    """Make all deferred calls, each once."""
    handles = list(waiting)
    waiting.clear()
    for handle in handles:
        handle()

"""Which tick of the generators is announced when: ahead of its first state where possible."""

from __future__ import annotations


class TickAnnouncer:
    """Ticks begin at multiples of the generators' step; each is announced once, or on a repeat.

    A tick is announced when the last state before it is answered, so that its plan is made while
    the robot moves and is there with the tick's first state. States with other stamps than
    expected only cost that head start.
    """

    def __init__(self, period_ns: int, tick_ns: int) -> None:
        """Control period and time between ticks [ns]."""
        self._period_ns = period_ns
        self._tick_ns = tick_ns
        self._announced = (-1, -1)  # epoch, start [ns]
        self._received_ns = -1  # state whose tick was asked for

    def on_state(self, stamp_ns: int, epoch: int) -> int | None:
        """Start [ns] of the tick to announce when a state arrives; None = it is known.

        The tick of a state that comes again is announced again: somebody waits for its plan.
        """
        repeated, self._received_ns = stamp_ns == self._received_ns, stamp_ns
        return self._due(stamp_ns, epoch, repeated)

    def on_answer(self, stamp_ns: int, epoch: int) -> int | None:
        """Start [ns] of the tick to announce when a state was answered: that of the next one."""
        return self._due(stamp_ns + self._period_ns, epoch, False)

    def _due(self, stamp_ns: int, epoch: int, again: bool) -> int | None:
        start_ns = stamp_ns - stamp_ns % self._tick_ns
        if (epoch, start_ns) <= self._announced and not again:
            return None
        self._announced = (epoch, start_ns)
        return start_ns

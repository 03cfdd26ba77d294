"""Which tick of the generators is announced when: ahead of its first state where possible."""

from __future__ import annotations


class TickAnnouncer:
    """Ticks begin at multiples of the generators' step; each is announced once, or on a repeat.

    A tick is announced half a tick ahead, at least with the last answer before its first state,
    so that its plan is made meanwhile and is there in time. States with other stamps than
    expected only cost that head start.
    """

    def __init__(self, period_ns: int, tick_ns: int) -> None:
        """Control period and time between ticks [ns]."""
        self._tick_ns = tick_ns
        self._lead_ns = max(period_ns, tick_ns // 2)
        self._announced = (-1, -1)  # epoch, start [ns]
        self._received_ns = -1  # state whose tick was asked for

    def on_state(self, stamp_ns: int, epoch: int) -> int | None:
        """Start [ns] of the tick to announce when a state arrives; None = it is known.

        The tick of a state that comes again is announced again: somebody waits for its plan.
        """
        repeated, self._received_ns = stamp_ns == self._received_ns, stamp_ns
        return self._due(stamp_ns, epoch, repeated)

    def on_answer(self, stamp_ns: int, epoch: int) -> int | None:
        """Start [ns] of the tick to announce when a state was answered: half a tick ahead."""
        return self._due(stamp_ns + self._lead_ns, epoch, False)

    def _due(self, stamp_ns: int, epoch: int, again: bool) -> int | None:
        start_ns = stamp_ns - stamp_ns % self._tick_ns
        if (epoch, start_ns) <= self._announced and not again:
            return None
        self._announced = (epoch, start_ns)
        return start_ns

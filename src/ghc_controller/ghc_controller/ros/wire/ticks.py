"""Schedules tick announcements for the generators, ahead of the first state if possible."""

from __future__ import annotations


class TickAnnouncer:
    """Ticks begin at multiples of the generators' step; each is announced once, or on a repeat.

    A tick is announced half a tick ahead, at the latest with the last answer before its first
    state, so that its plan is computed in parallel and arrives in time. States with unexpected
    stamps lose only this head start. While an epoch waits at its first state nothing is announced
    ahead, since scripted messages arrive then.
    """

    def __init__(self, period_ns: int, tick_ns: int) -> None:
        """Control period and time between ticks [ns]."""
        self._tick_ns = tick_ns
        self._lead_ns = max(period_ns, tick_ns // 2)
        self._announced = (-1, -1)  # epoch, start [ns]
        self._received = (-1, -1)  # epoch, stamp [ns] of the last state
        self._first_ns = -1  # stamp of the first state of the epoch

    def on_state(self, stamp_ns: int, epoch: int) -> int | None:
        """Start [ns] of the tick to announce when a state arrives; None = it is known.

        The tick of a repeated state is announced again, since its plan is missing. An older stamp
        means a restarted robot: the ticks restart as well.
        """
        repeated = (epoch, stamp_ns) == self._received
        if (epoch, stamp_ns) < self._received:
            self._announced, self._received = (-1, -1), (-1, -1)
        if epoch != self._received[0]:
            self._first_ns = stamp_ns
        self._received = (epoch, stamp_ns)
        tick = (epoch, stamp_ns - stamp_ns % self._tick_ns)
        if tick > self._announced or (repeated and tick == self._announced):
            self._announced = tick
            return tick[1]
        return None

    def on_answer(self, stamp_ns: int, epoch: int) -> int | None:
        """Start [ns] of the tick to announce when a state was answered: half a tick ahead."""
        ahead_ns = stamp_ns + self._lead_ns
        tick = (epoch, ahead_ns - ahead_ns % self._tick_ns)
        if stamp_ns == self._first_ns or tick <= self._announced:
            return None
        self._announced = tick
        return tick[1]

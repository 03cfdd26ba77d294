"""Which clock a recording runs on: simulated time if there is any, else the wall's."""

from __future__ import annotations

from collections.abc import Callable

Write = Callable[[int], None]  # told the log time [ns]

PATIENCE_NS = 30_000_000_000  # [ns] wall; no /clock until then: nobody simulates


class RecordingTimeline:
    """Log times for messages; the ones before the decision wait for it.

    A file in which some messages lie at t = 0.2 s and others fifty years later is of no use to
    a viewer, and a node may speak before the first /clock arrives.
    """

    def __init__(self, start_ns: int) -> None:
        """Begin undecided at wall time `start_ns` [ns]."""
        self._start_ns = start_ns
        self._simulated_ns: int | None = None
        self._on_wall = False
        self._waiting: list[tuple[int, Write]] = []

    def clock(self, stamp_ns: int) -> None:
        """Simulated time is `stamp_ns` [ns]."""
        if self._on_wall:
            return
        self._simulated_ns = stamp_ns
        if self._waiting:
            self._release(stamp_ns)

    def write(self, wall_ns: int, write: Write) -> None:
        """Call `write` with the log time of a message received at `wall_ns` [ns], now or later."""
        if self._simulated_ns is not None:
            write(self._simulated_ns)
        elif self._on_wall:
            write(wall_ns)
        else:
            self._waiting.append((wall_ns, write))
            if wall_ns - self._start_ns > PATIENCE_NS:
                self.decide()

    def decide(self) -> None:
        """No clock so far: the recording runs on wall time."""
        if self._simulated_ns is None and not self._on_wall:
            self._on_wall = True
            self._release(None)

    def _release(self, simulated_ns: int | None) -> None:
        for wall_ns, write in self._waiting:
            write(wall_ns if simulated_ns is None else simulated_ns)
        self._waiting.clear()

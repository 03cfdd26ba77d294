"""Clock of a recording: simulated time if there is any, else wall time."""

from __future__ import annotations

from collections.abc import Callable

from ghc_controller.ros.wire.in_a_row import InARow

Write = Callable[[int], None]  # called with the log time [ns]

MOST_AHEAD_NS = 10_000_000_000  # [ns] of /clock, at once
IN_A_ROW = 3  # [-] consecutive times far ahead after which a jump is accepted
PATIENCE_NS = 30_000_000_000  # [ns] wall; no /clock until then: there is no simulation


class RecordingTimeline:
    """Log times for messages; those before the first /clock are moved when it comes.

    A file in which some messages lie at t = 0.2 s and others fifty years later is of no use to
    a viewer, and a node may publish before the first /clock arrives. Until then messages are
    written with wall time, so that they are on the disk, and kept to be written again.
    """

    def __init__(self, start_ns: int, restart: Callable[[], None]) -> None:
        """Begin undecided at wall time `start_ns` [ns]; `restart` empties the recording."""
        self._start_ns = start_ns
        self._restart = restart
        self._simulated_ns: int | None = None
        self._far = InARow(IN_A_ROW, MOST_AHEAD_NS)
        self._on_wall = False
        self._early: list[Write] = []

    def clock(self, stamp_ns: int) -> None:
        """Simulated time is `stamp_ns` [ns]; a single one far ahead is ignored."""
        if self._on_wall or self._is_far_ahead(stamp_ns):
            return
        self._simulated_ns = stamp_ns
        early, self._early = self._early, []
        if early:
            self._restart()
        for write in early:
            write(stamp_ns)

    def _is_far_ahead(self, stamp_ns: int) -> bool:
        if self._simulated_ns is None or stamp_ns - self._simulated_ns <= MOST_AHEAD_NS:
            self._far.forget()
            return False
        return not self._far.hear(stamp_ns)

    def write(self, wall_ns: int, write: Write) -> None:
        """Call `write` with the log time of a message received at `wall_ns` [ns]."""
        if self._simulated_ns is not None:
            write(self._simulated_ns)
            return
        write(wall_ns)
        if self._on_wall:
            return
        self._early.append(write)
        if wall_ns - self._start_ns > PATIENCE_NS:
            self._on_wall = True
            self._early.clear()

"""Detects that all earlier schedules of a row have arrived after a start during a run."""

from __future__ import annotations

from collections.abc import Iterable

QUIET = 0.2  # [s] wall without a further schedule: complete
LONGEST = 1.0  # [s] wall after the first one: longest wait for a planner that keeps sending


class ScheduleHistory:
    """Waits for the schedules that were sent before this generator was started.

    Schedules are latched for nodes that start later. They arrive one by one, oldest first, with
    pauses under load, and an outdated one may allow what its successor forbids. The last one is
    not marked, so a row with active bounds waits until no schedule has arrived for a while.
    """

    def __init__(self, quiet: float = QUIET, longest: float = LONGEST) -> None:
        """Both in [s] wall time, like every `wall` below."""
        self._quiet, self._longest = quiet, longest
        self._expected: set[str] = set()  # rows that still wait
        self._first: dict[str, float] = {}  # row -> [s] of its first schedule
        self._last: dict[str, float] = {}

    def expect(self, rows: Iterable[str]) -> None:
        """Wait for these rows: they have current bounds, so schedules were sent for them."""
        self._expected = set(rows)

    def arrived(self, row: str, wall: float) -> None:
        """Register a schedule."""
        self._first.setdefault(row, wall)
        self._last[row] = wall

    def is_complete(self, row: str, wall: float) -> bool:
        """Whether the schedules of a row can be used; stays True."""
        if row not in self._expected:
            return True
        if row not in self._last:
            return False
        quiet = wall - self._last[row] >= self._quiet
        if quiet or wall - self._first[row] >= self._longest:
            self._expected.discard(row)
            return True
        return False

    def forget(self) -> None:
        """Stop waiting: time restarts."""
        self._expected.clear()

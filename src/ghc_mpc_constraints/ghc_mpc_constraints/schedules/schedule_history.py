"""After a start in the middle of a run: have all the schedules of a row come?"""

from __future__ import annotations

from collections.abc import Iterable

QUIET = 0.2  # [s] wall without a further schedule: that was all
LONGEST = 1.0  # [s] wall after the first one: a planner that goes on speaking is not waited for


class ScheduleHistory:
    """Tells when the schedules that were sent before the start of this generator have come.

    The topic keeps a planner's schedules for who starts later. They come one by one, the oldest
    first, under load with pauses between: one that was replaced long ago may allow what the next
    one forbids. Nothing says which is the last, so a row whose bounds are in force waits
    until none has come for a while.
    """

    def __init__(self, quiet: float = QUIET, longest: float = LONGEST) -> None:
        """Both in [s] of the wall clock, like every `wall` below."""
        self._quiet, self._longest = quiet, longest
        self._expected: set[str] = set()  # rows that still wait
        self._first: dict[str, float] = {}  # row -> [s] of its first schedule
        self._last: dict[str, float] = {}

    def expect(self, rows: Iterable[str]) -> None:
        """These have bounds in force, so somebody has sent schedules for them."""
        self._expected = set(rows)

    def arrived(self, row: str, wall: float) -> None:
        """Take note of a schedule."""
        self._first.setdefault(row, wall)
        self._last[row] = wall

    def is_complete(self, row: str, wall: float) -> bool:
        """Whether the schedules of a row may be used; once they may, they always may."""
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
        """Nothing is waited for: time starts again."""
        self._expected.clear()

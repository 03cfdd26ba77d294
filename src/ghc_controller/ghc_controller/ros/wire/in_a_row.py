"""Stamps of a clock that one does not follow: several in a row are needed to believe it."""

from __future__ import annotations


class InARow:
    """Counts stamps each of which follows the one before; a forged one, or its repeats, do not."""

    def __init__(self, count: int, most_step_ns: int) -> None:
        """`count` of them are needed, at most `most_step_ns` [ns] from one to the next."""
        self._count, self._most_step_ns = count, most_step_ns
        self.forget()

    def forget(self) -> None:
        """None was heard yet."""
        self._last_ns, self._found = 0, 0

    def hear(self, stamp_ns: int) -> bool:
        """Take a stamp; True where it is the last one needed, and the count begins anew."""
        follows = self._found > 0 and 0 < stamp_ns - self._last_ns <= self._most_step_ns
        self._found = self._found + 1 if follows else 1
        self._last_ns = stamp_ns
        if self._found < self._count:
            return False
        self.forget()
        return True

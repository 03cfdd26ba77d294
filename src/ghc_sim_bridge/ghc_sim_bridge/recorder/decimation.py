"""Thinning a fast topic to a grid of simulated time."""

from __future__ import annotations


class Decimator:
    """Keeps the first message at or after every grid point, so that topics stay aligned."""

    def __init__(self, period_ns: int) -> None:
        """Keep one message per `period_ns` [ns] of its stamp."""
        self._period_ns = period_ns
        self._last_cell: int | None = None

    def keeps(self, stamp_ns: int) -> bool:
        """Whether the message of `stamp_ns` [ns] is kept; restarts if time goes back."""
        cell = stamp_ns // self._period_ns
        if cell == self._last_cell:
            return False
        self._last_cell = cell
        return True

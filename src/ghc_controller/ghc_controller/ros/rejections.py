"""Counts of what a node refused or corrected, by field, and when to say so."""

from __future__ import annotations

from collections import Counter

WARNING_PERIOD = 1.0  # [s] at most one warning per field in this time


class Rejections:
    """Counts events per field; warns of each field at most once per period."""

    def __init__(self) -> None:
        """Begin with no events."""
        self.counts: Counter[str] = Counter()
        self._warned_at: dict[str, float] = {}

    def count(self, field: str, now: float) -> bool:
        """Note an event of `field` at `now` [s]; True when it is time to warn."""
        self.counts[field] += 1
        if now - self._warned_at.get(field, -WARNING_PERIOD) < WARNING_PERIOD:
            return False
        self._warned_at[field] = now
        return True

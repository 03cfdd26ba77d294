"""Detects when accepted references end: done, or replaced before their end."""

from __future__ import annotations

from bisect import bisect_right, insort_right
from dataclasses import dataclass
from enum import Enum

from ghc_controller.references.reference import ReferenceTrajectory


class ReferencePhase(Enum):
    """How a reference ended; the names of ghc_msgs/TaskReferenceStatus."""

    DONE = "DONE"
    REPLACED = "REPLACED"


@dataclass(frozen=True, slots=True)
class ReferenceEvent:
    """End of one reference."""

    phase: ReferencePhase
    time: float  # [s] of detection
    id: str
    task: str
    start: float  # [s]
    reason: str = ""


@dataclass(slots=True)
class _Open:
    id: str
    reference: ReferenceTrajectory
    ends: bool  # its end has not been reported yet; single points never report one
    hidden: bool  # an active reference started later: this one is never followed

    def ended(self, phase: ReferencePhase, time: float, reason: str = "") -> ReferenceEvent:
        reference, self.ends = self.reference, False
        return ReferenceEvent(phase, time, self.id, reference.task, reference.start_time, reason)


def _start(entry: _Open) -> float:
    return entry.reference.start_time


class ReferenceProgress:
    """Tracks accepted references with several points until they end.

    As in `ReferenceSchedule`, a task follows the reference that started last, and of two with the
    same start the newer one. A single point has no end; it is tracked only because it may replace
    others. The active reference stays active after its end: a reference with an earlier start
    that arrives later is never followed.
    """

    def __init__(self) -> None:
        """Start without references."""
        self._open: dict[str, list[_Open]] = {}  # task -> in the order of their starts
        self._now = float("-inf")  # [s] of the last `advance` or `end_all`

    def add(self, request_id: str, reference: ReferenceTrajectory) -> None:
        """Register an accepted reference."""
        entries, start = self._open.setdefault(reference.task, []), reference.start_time
        begun = bisect_right(entries, self._now, key=_start)
        hidden = begun > 0 and start < _start(entries[begun - 1])
        entry = _Open(request_id, reference, len(reference.times) > 1, hidden)
        insort_right(entries, entry, key=_start)

    def advance(self, now: float) -> list[ReferenceEvent]:
        """References that have ended by `now` [s]."""
        self._now = now
        events: list[ReferenceEvent] = []
        for entries in self._open.values():
            while len(entries) > 1 and entries[1].reference.start_time <= now:
                entry, newer = entries.pop(0), entries[0].reference
                if not entry.ends:
                    continue
                if entry.reference.end_time <= newer.start_time and not entry.hidden:
                    events.append(entry.ended(ReferencePhase.DONE, now))
                else:
                    words = "a newer one has begun"
                    events.append(entry.ended(ReferencePhase.REPLACED, now, words))
            first = entries[0]
            if first.ends and first.reference.end_time <= now:
                events.append(first.ended(ReferencePhase.DONE, now))
        return events

    def end_all(self, now: float, reason: str) -> list[ReferenceEvent]:
        """End all references at `now` [s] for a `reason`."""
        self._now = now
        events = [
            entry.ended(ReferencePhase.REPLACED, now, reason)
            for entries in self._open.values()
            for entry in entries
            if entry.ends
        ]
        self._open.clear()
        return events

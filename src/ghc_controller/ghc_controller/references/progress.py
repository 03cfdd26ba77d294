"""What becomes of references that were accepted: done, or replaced before their end."""

from __future__ import annotations

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
    time: float  # [s] at which it was noticed
    id: str
    task: str
    start: float  # [s]
    reason: str = ""


@dataclass(frozen=True, slots=True)
class _Open:
    id: str
    reference: ReferenceTrajectory

    def ended(self, phase: ReferencePhase, time: float, reason: str = "") -> ReferenceEvent:
        reference = self.reference
        return ReferenceEvent(phase, time, self.id, reference.task, reference.start_time, reason)


class ReferenceProgress:
    """Follows accepted references of several points to their end.

    As in `ReferenceSchedule`, of the references of a task the one that started last is followed;
    of two with the same start the newer one. A single point has no end: it is only followed as
    what may replace others.
    """

    def __init__(self) -> None:
        """None was accepted yet."""
        self._open: dict[str, list[_Open]] = {}  # task -> in the order of their starts

    def add(self, request_id: str, reference: ReferenceTrajectory) -> None:
        """A reference was accepted."""
        entries = self._open.setdefault(reference.task, [])
        entries.append(_Open(request_id, reference))
        entries.sort(key=lambda entry: entry.reference.start_time)

    def advance(self, now: float) -> list[ReferenceEvent]:
        """What has ended at `now` [s]."""
        events: list[ReferenceEvent] = []
        for task, entries in list(self._open.items()):
            while entries and entries[0].reference.start_time <= now:
                entry, reference = entries[0], entries[0].reference
                follows = entries[1].reference if len(entries) > 1 else None
                begun = follows is not None and follows.start_time <= now
                end = reference.start_time + float(reference.times[-1])
                several = len(reference.times) > 1
                if follows is not None and begun and several and follows.start_time < end:
                    events.append(
                        entry.ended(ReferencePhase.REPLACED, now, "a newer one has begun")
                    )
                elif several and end <= now:
                    events.append(entry.ended(ReferencePhase.DONE, now))
                elif several and not begun:
                    break
                entries.pop(0)
            if not entries:
                del self._open[task]
        return events

    def end_all(self, now: float, reason: str) -> list[ReferenceEvent]:
        """Nothing is followed any more from `now` [s] on, for a `reason`."""
        events = [
            entry.ended(ReferencePhase.REPLACED, now, reason)
            for entries in self._open.values()
            for entry in entries
            if len(entry.reference.times) > 1
        ]
        self._open.clear()
        return events

"""Contact schedules that have come: judged at once, used from the time at which they are known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ghc_controller.errors import InvalidValue
from ghc_mpc_constraints.force_bounds.contact_schedule import ContactSchedule

# Schedules of a contact that are known again after a reset. The first ones are the script of the
# run; a planner that sends more than these speaks again in the next epoch, and for itself.
MOST_KEPT = 100


@dataclass(frozen=True, slots=True, eq=False)
class TimedSchedule:
    """A schedule and the time from which the generator may look at it."""

    schedule: ContactSchedule
    known_from: float | None  # [s]; None = on receipt

    def supersedes(self, older: TimedSchedule) -> bool:
        """Whether nothing of `older` is ever looked at, this one having come after it."""
        return (
            self.schedule.contact == older.schedule.contact
            and self.known_from == older.known_from
            and bool(self.schedule.times[0] <= older.schedule.times[0])
        )


class ScheduleInbox:
    """Holds schedules back until they are known, and keeps them for when time starts again.

    In lockstep nothing may depend on when a message arrives: once ticks have begun, a schedule
    has to say from when it is known, and that time must be to come.
    """

    def __init__(self, lockstep: bool) -> None:
        self._lockstep = lockstep
        self._waiting: list[TimedSchedule] = []
        self._kept: list[TimedSchedule] = []  # in the order of receipt
        self.not_kept = 0  # beyond the first MOST_KEPT of their contact

    def put(self, timed: TimedSchedule, now: float, running: bool) -> bool:
        """Take a schedule at `now` [s]; True when it is known at once.

        Raises:
            InvalidValue: too late for lockstep; the schedules before stay in force.
        """
        known = timed.known_from
        if self._lockstep and running and (known is None or known <= now):
            given = "no known_from" if known is None else f"known_from {known:g} s"
            raise InvalidValue(
                f"schedule of contact '{timed.schedule.contact}': {given} given, later than "
                f"{now:g} s (now) expected: in lockstep a late request would make the run depend "
                "on when it arrived"
            )
        self._waiting.append(timed)
        self._keep(timed)
        return known is None or known <= now

    def due(
        self, now: float, may_use: Callable[[str], bool] = lambda _contact: True
    ) -> list[ContactSchedule]:
        """Schedules known at `now` [s], in the order in which they became so.

        Those of a contact that `may_use` refuses wait.
        """
        ready = [
            timed
            for timed in self._waiting
            if (timed.known_from is None or timed.known_from <= now + 1e-9)
            and may_use(timed.schedule.contact)
        ]
        self._waiting = [t for t in self._waiting if t not in ready]
        ready.sort(key=lambda t: -1.0 if t.known_from is None else t.known_from)
        return [timed.schedule for timed in ready]

    def restart(self) -> None:
        """Hold everything back again: time starts again.

        A schedule without known_from is known from the start of the new epoch.
        """
        self._waiting = list(self._kept)

    def _keep(self, timed: TimedSchedule) -> None:
        self._kept = [older for older in self._kept if not timed.supersedes(older)]
        contact = timed.schedule.contact
        if sum(kept.schedule.contact == contact for kept in self._kept) < MOST_KEPT:
            self._kept.append(timed)
        else:
            self.not_kept += 1

"""Contact schedules that have come: judged at once, used from the time at which they are known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ghc_controller.errors import InvalidValue
from ghc_mpc_constraints.force_bounds.contact_schedule import ContactSchedule


@dataclass(frozen=True, slots=True, eq=False)
class TimedSchedule:
    """A schedule and the time from which the generator may look at it."""

    schedule: ContactSchedule
    known_from: float | None  # [s]; None = on receipt


class ScheduleInbox:
    """Holds schedules back until they are known.

    In lockstep nothing may depend on when a message arrives: once ticks have begun, a schedule
    has to say from when it is known, and that time must be to come.
    """

    def __init__(self, lockstep: bool) -> None:
        self._lockstep = lockstep
        self._waiting: list[TimedSchedule] = []

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

    def forget(self) -> None:
        """Another run begins."""
        self._waiting.clear()

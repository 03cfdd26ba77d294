"""Schedules that have come: judged at once, used from the time at which they are known."""

from __future__ import annotations

from collections.abc import Callable

from ghc_controller.errors import InvalidValue
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule


class ScheduleInbox:
    """Holds schedules back until they are known.

    In lockstep nothing may depend on when a message arrives: once ticks have begun, a schedule
    has to say from when it is known, and that time must be to come.
    """

    def __init__(self, lockstep: bool) -> None:
        self._lockstep = lockstep
        self._waiting: list[LimitSchedule] = []

    def put(self, schedule: LimitSchedule, now: float, running: bool) -> bool:
        """Take a schedule at `now` [s]; True when it is known at once.

        Raises:
            InvalidValue: too late for lockstep; the schedules before stay in force.
        """
        known = schedule.known_from
        if self._lockstep and running and (known is None or known <= now):
            given = "no known_from" if known is None else f"known_from {known:g} s"
            raise InvalidValue(
                f"schedule of {schedule.THING} '{schedule.name}': {given} given, later than "
                f"{now:g} s (now) expected: in lockstep a late request would make the run depend "
                "on when it arrived"
            )
        self._waiting.append(schedule)
        return known is None or known <= now

    def due(
        self, now: float, may_use: Callable[[str], bool] = lambda _name: True
    ) -> list[LimitSchedule]:
        """Schedules known at `now` [s], in the order in which they became so.

        Those of a contact that `may_use` refuses wait.
        """
        ready = [
            schedule
            for schedule in self._waiting
            if (schedule.known_from is None or schedule.known_from <= now + 1e-9)
            and may_use(schedule.name)
        ]
        self._waiting = [t for t in self._waiting if t not in ready]
        ready.sort(key=lambda t: -1.0 if t.known_from is None else t.known_from)
        return ready

    def forget(self) -> None:
        """Another run begins."""
        self._waiting.clear()

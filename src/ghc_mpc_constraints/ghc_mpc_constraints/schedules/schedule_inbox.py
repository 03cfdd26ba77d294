"""Received schedules: checked at once, used from their `known_from` on."""

from __future__ import annotations

from collections.abc import Callable

from ghc_controller.errors import InvalidValue
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule

MOST_WAITING = 1000  # [-] schedules that are not known yet, or may not be used yet


class ScheduleInbox:
    """Holds schedules back until their `known_from`.

    In lockstep a run must not depend on when messages arrive: once ticks have begun, a schedule
    must have a `known_from` in the future.
    """

    def __init__(self, lockstep: bool) -> None:
        self._lockstep = lockstep
        self._waiting: list[LimitSchedule] = []

    def put(self, schedule: LimitSchedule, now: float, running: bool) -> bool:
        """Add a schedule at `now` [s]; True if it applies at once.

        Raises:
            InvalidValue: too late for lockstep, or too many wait; the previous schedules stay
                active.
        """
        known = schedule.known_from
        if self._lockstep and running and (known is None or known <= now):
            given = "no known_from" if known is None else f"known_from {known:g} s"
            raise InvalidValue(
                f"schedule of {schedule.THING} '{schedule.name}': {given} given, later than "
                f"{now:g} s (now) expected: in lockstep a late request would make the run depend "
                "on when it arrived"
            )
        if len(self._waiting) >= MOST_WAITING:
            raise InvalidValue(
                f"schedule of {schedule.THING} '{schedule.name}': {len(self._waiting)} schedules "
                f"wait for their known_from, less than {MOST_WAITING} expected"
            )
        self._waiting.append(schedule)
        return known is None or known <= now

    def due(
        self, now: float, may_use: Callable[[str], bool] = lambda _name: True
    ) -> list[LimitSchedule]:
        """Schedules known at `now` [s], in the order of `known_from`.

        Schedules of a row wait until `may_use` accepts it.
        """
        ready: list[LimitSchedule] = []
        waiting: list[LimitSchedule] = []
        for schedule in self._waiting:
            known = schedule.known_from is None or schedule.known_from <= now + 1e-9
            (ready if known and may_use(schedule.name) else waiting).append(schedule)
        self._waiting = waiting
        ready.sort(key=lambda t: -1.0 if t.known_from is None else t.known_from)
        return ready

    def forget(self) -> None:
        """A new run begins."""
        self._waiting.clear()

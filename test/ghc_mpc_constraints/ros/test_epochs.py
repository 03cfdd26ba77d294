"""Time that starts again: the second epoch of a generator is planned like the first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ghc_controller.previews.bounds_plan import ForceBoundsPlan
from ghc_mpc_constraints.force_bounds.contact_force_bounds import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.force_bounds.contact_schedule import ContactSchedule
from ghc_mpc_constraints.ros import schedule_inbox
from ghc_mpc_constraints.ros.schedule_inbox import MOST_KEPT, ScheduleInbox, TimedSchedule

SETTINGS = ForceBoundSettings(horizon=0.25)
EVERY = 0.05  # [s] between the ticks of an epoch
END = 12.0  # [s]
SCRIPT = ContactSchedule.checked("right_sole", [0.0, 3.5, 7.0], [0.0] * 3, [400.0, 0.0, 400.0])
NEWER = ContactSchedule.checked("right_sole", [10.0], [0.0], [100.0])


class Generator:
    """Inbox and generator, wired as the node wires them."""

    def __init__(self, lockstep: bool) -> None:
        self.bounds = ContactForceBounds(SETTINGS)
        self.inbox = ScheduleInbox(lockstep)

    def reset(self) -> None:
        """What a new epoch does."""
        self.bounds.reset()
        self.inbox.restart()

    def epoch(self, arrivals: Sequence[tuple[float, TimedSchedule]] = ()) -> list[ForceBoundsPlan]:
        """Plans of all ticks; each schedule arrives before the tick at its time [s]."""
        plans, arrivals = [], list(arrivals)
        for k in range(round(END / EVERY)):
            now = k * EVERY
            while arrivals and arrivals[0][0] <= now + 1e-9:
                self.inbox.put(arrivals.pop(0)[1], now, running=k > 0)
            for schedule in self.inbox.due(now):
                self.bounds.set_schedule(schedule, now)
            plans.append(self.bounds.tick(now))
        return plans


def assert_equal_plans(first: list[ForceBoundsPlan], second: list[ForceBoundsPlan]) -> None:
    for before, after in zip(first, second, strict=True):
        assert before.contacts == after.contacts
        assert before.in_contact == after.in_contact
        assert before.status == after.status
        np.testing.assert_array_equal(before.lower, after.lower)
        np.testing.assert_array_equal(before.upper, after.upper)


def test_what_a_newer_schedule_made_the_past_is_known_again() -> None:
    """At 5 s the foot is off and a schedule from 10 s on comes: at 0 s the foot is on again."""
    generator = Generator(lockstep=False)
    script = [(0.0, TimedSchedule(SCRIPT, None)), (5.0, TimedSchedule(NEWER, None))]
    first = generator.epoch(script)
    for _ in range(2):
        generator.reset()
        second = generator.epoch()
        assert second[0].in_contact == (True,)
        assert_equal_plans(first, second)


def test_a_schedule_is_known_from_the_same_time_in_every_epoch() -> None:
    """A surprise at 3 s, for 3.1 s: without it in the plans before, however often time starts."""
    surprise = ContactSchedule.checked("right_sole", [3.1], [0.0], [50.0])
    other = ContactSchedule.checked("left_sole", [0.0], [0.0], [200.0])
    generator = Generator(lockstep=True)
    script = [
        (0.0, TimedSchedule(SCRIPT, None)),
        (0.0, TimedSchedule(surprise, 3.0)),
        (1.0, TimedSchedule(other, 2.0)),
    ]
    first = generator.epoch(script)
    assert (first[59].upper[1] == 400.0).all()
    np.testing.assert_allclose(first[60].upper[1][11:], 50.0)
    generator.reset()
    assert_equal_plans(first, generator.epoch())


def test_a_reset_before_a_schedule_is_known_loses_and_doubles_nothing() -> None:
    inbox = ScheduleInbox(lockstep=True)
    inbox.put(TimedSchedule(SCRIPT, None), 0.0, running=False)
    inbox.put(TimedSchedule(NEWER, 3.0), 0.0, running=False)
    for _ in range(2):
        assert inbox.due(0.0) == [SCRIPT]
        inbox.restart()
    assert inbox.due(4.0) == [SCRIPT, NEWER]


@pytest.mark.parametrize("known_from", [None, 3.0])
def test_a_schedule_sent_again_and_again_is_kept_once(known_from: float | None) -> None:
    """Also one that begins earlier: nothing of the one before is ever looked at."""
    inbox = ScheduleInbox(lockstep=False)
    for k in range(3 * MOST_KEPT):
        last = ContactSchedule.checked("right_sole", [5.0 - k % 2 - k // 2], [0.0], [float(k)])
        inbox.put(TimedSchedule(last, known_from), 0.0, running=False)
    inbox.restart()
    assert inbox.due(9.0) == [last]
    assert inbox.not_kept == 0


def test_what_supersedes_only_a_part_leaves_the_rest() -> None:
    """A later beginning, another time of becoming known, another contact."""
    early = ContactSchedule.checked("right_sole", [-1.0], [0.0], [9.0])
    other = ContactSchedule.checked("left_sole", [-1.0], [0.0], [9.0])
    inbox = ScheduleInbox(lockstep=False)
    for timed in ((SCRIPT, None), (NEWER, None), (early, 3.0), (other, None)):
        inbox.put(TimedSchedule(*timed), 0.0, running=False)
    inbox.restart()
    assert inbox.due(0.0) == [SCRIPT, NEWER, other]
    assert inbox.due(3.0) == [early]


def test_schedules_for_hours_leave_the_beginning_of_the_script_and_no_more() -> None:
    """A planner that looks ahead: each schedule begins later than the one before."""
    inbox = ScheduleInbox(lockstep=False)
    inbox.put(TimedSchedule(SCRIPT, None), 0.0, running=False)
    for k in range(5000):
        moving = ContactSchedule.checked("right_sole", [1.0 + 0.1 * k], [0.0], [50.0])
        inbox.put(TimedSchedule(moving, None), 0.1 * k, running=True)
        inbox.due(0.1 * k)
    other = ContactSchedule.checked("left_sole", [0.0], [0.0], [200.0])
    inbox.put(TimedSchedule(other, None), 500.0, running=True)
    inbox.restart()
    again = inbox.due(0.0)
    assert again[0] is SCRIPT
    assert again[-1] is other
    assert len(again) == schedule_inbox.MOST_KEPT + 1
    assert inbox.not_kept == 5001 - MOST_KEPT

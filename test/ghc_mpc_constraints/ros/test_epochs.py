"""Time that starts again: the second epoch of a generator is planned like the first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ghc_controller.previews.preview import Preview
from ghc_mpc_constraints.generators.contact_forces import (
    ContactForceBounds,
    ForceBoundSettings,
)
from ghc_mpc_constraints.schedules import schedule_inbox
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.schedule_inbox import MOST_KEPT, ScheduleInbox

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

    def epoch(self, arrivals: Sequence[tuple[float, ContactSchedule]] = ()) -> list[Preview]:
        """Plans of all ticks; each schedule arrives before the tick at its time [s]."""
        plans, arrivals = [], list(arrivals)
        for k in range(round(END / EVERY)):
            now = k * EVERY
            while arrivals and arrivals[0][0] <= now + 1e-9:
                self.inbox.put(arrivals.pop(0)[1], now, running=k > 0)
            for schedule in self.inbox.due(now):
                self.bounds.observe(schedule, now)
            plans.append(self.bounds.tick(now))
        return plans


def assert_equal_plans(first: list[Preview], second: list[Preview]) -> None:
    for before, after in zip(first, second, strict=True):
        assert before.rows == after.rows
        assert before.active == after.active
        assert before.status == after.status
        np.testing.assert_array_equal(before.lower, after.lower)
        np.testing.assert_array_equal(before.upper, after.upper)


def test_what_a_newer_schedule_made_the_past_is_known_again() -> None:
    """At 5 s the foot is off and a schedule from 10 s on comes: at 0 s the foot is on again."""
    generator = Generator(lockstep=False)
    script = [(0.0, SCRIPT), (5.0, NEWER)]
    first = generator.epoch(script)
    for _ in range(2):
        generator.reset()
        second = generator.epoch()
        assert second[0].active == (True,)
        assert_equal_plans(first, second)


def test_a_schedule_is_known_from_the_same_time_in_every_epoch() -> None:
    """A surprise at 3 s, for 3.1 s: without it in the plans before, however often time starts."""
    surprise = ContactSchedule.checked("right_sole", [3.1], [0.0], [50.0])
    other = ContactSchedule.checked("left_sole", [0.0], [0.0], [200.0])
    generator = Generator(lockstep=True)
    script = [
        (0.0, SCRIPT),
        (0.0, surprise.known_at(3.0)),
        (1.0, other.known_at(2.0)),
    ]
    first = generator.epoch(script)
    assert (first[59].upper[1] == 400.0).all()
    np.testing.assert_allclose(first[60].upper[1][11:], 50.0)
    generator.reset()
    assert_equal_plans(first, generator.epoch())


def test_a_reset_before_a_schedule_is_known_loses_and_doubles_nothing() -> None:
    inbox = ScheduleInbox(lockstep=True)
    inbox.put(SCRIPT, 0.0, running=False)
    newer = NEWER.known_at(3.0)
    inbox.put(newer, 0.0, running=False)
    for _ in range(2):
        assert inbox.due(0.0) == [SCRIPT]
        inbox.restart()
    assert inbox.due(4.0) == [SCRIPT, newer]


@pytest.mark.parametrize("known_from", [None, 3.0])
def test_a_schedule_sent_again_and_again_is_kept_once(known_from: float | None) -> None:
    """Also one that begins earlier: nothing of the one before is ever looked at."""
    inbox = ScheduleInbox(lockstep=False)
    for k in range(3 * MOST_KEPT):
        last = ContactSchedule.checked("right_sole", [5.0 - k % 2 - k // 2], [0.0], [float(k)])
        last = last.known_at(known_from)
        inbox.put(last, 0.0, running=False)
    inbox.restart()
    assert inbox.due(9.0) == [last]
    assert inbox.not_kept == 0


def test_what_supersedes_only_a_part_leaves_the_rest() -> None:
    """A later beginning, another time of becoming known, another contact."""
    early = ContactSchedule.checked("right_sole", [-1.0], [0.0], [9.0], known_from=3.0)
    other = ContactSchedule.checked("left_sole", [-1.0], [0.0], [9.0])
    inbox = ScheduleInbox(lockstep=False)
    for schedule in (SCRIPT, NEWER, early, other):
        inbox.put(schedule, 0.0, running=False)
    inbox.restart()
    assert inbox.due(0.0) == [SCRIPT, NEWER, other]
    assert inbox.due(3.0) == [early]


def test_schedules_for_hours_leave_the_beginning_of_the_script_and_no_more() -> None:
    """A planner that looks ahead: each schedule begins later than the one before."""
    inbox = ScheduleInbox(lockstep=False)
    inbox.put(SCRIPT, 0.0, running=False)
    for k in range(5000):
        moving = ContactSchedule.checked("right_sole", [1.0 + 0.1 * k], [0.0], [50.0])
        inbox.put(moving, 0.1 * k, running=True)
        inbox.due(0.1 * k)
    other = ContactSchedule.checked("left_sole", [0.0], [0.0], [200.0])
    inbox.put(other, 500.0, running=True)
    inbox.restart()
    again = inbox.due(0.0)
    assert again[0] is SCRIPT
    assert again[-1] is other
    assert len(again) == schedule_inbox.MOST_KEPT + 1
    assert inbox.not_kept == 5001 - MOST_KEPT

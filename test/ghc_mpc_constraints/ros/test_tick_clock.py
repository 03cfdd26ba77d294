"""Ticks by the stamps of states, and schedules held back until they are known."""

from __future__ import annotations

import pytest

from ghc_controller.errors import InvalidValue
from ghc_controller.ros.wire.timeline import CONFIRMATIONS, SILENCE
from ghc_mpc_constraints.ros.tick_clock import Due, TickClock
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.schedule_inbox import ScheduleInbox

MS = 1_000_000  # [ns]


def test_ticks_are_multiples_of_the_step() -> None:
    """At 1 kHz and a step of 10 ms: one plan in ten states, each at a multiple of the step."""
    clock = TickClock(10 * MS)
    planned = []
    for k in range(35):
        if clock.judge(k * MS, 0) is Due.PLAN:
            planned.append(clock.planned(k * MS))
    assert planned == [0, 10 * MS, 20 * MS, 30 * MS]


def test_repeats_are_answered_alike_and_a_missed_tick_is_made_up_for() -> None:
    clock = TickClock(10 * MS)
    assert clock.judge(0, 0) is Due.PLAN
    clock.planned(0)
    assert clock.judge(0, 0) is Due.REPEAT
    assert clock.judge(3 * MS, 0) is Due.NOTHING
    assert clock.judge(27 * MS, 0) is Due.PLAN
    assert clock.planned(27 * MS) == 20 * MS
    assert clock.judge(28 * MS, 0) is Due.NOTHING
    assert clock.judge(20 * MS, 0) is Due.REPEAT
    clock.forget()
    assert clock.judge(20 * MS, 0) is Due.PLAN


def test_time_runs_backwards_only_with_a_confirmed_epoch() -> None:
    wall = [0.0]
    clock = TickClock(10 * MS, lambda: wall[0])
    clock.judge(50 * MS, 0)
    clock.planned(50 * MS)
    assert clock.judge(30 * MS, 0) is Due.STALE
    for _ in range(CONFIRMATIONS - 1):
        wall[0] += SILENCE
        assert clock.judge(0, 1) is Due.IMPLAUSIBLE
    wall[0] += SILENCE
    news = []
    for _ in range(2):
        assert clock.judge(0, 1) in (Due.PLAN, Due.REPEAT)
        news.append(clock.new_epoch)
        clock.planned(0)
    assert news == [True, False]
    assert clock.epoch == 1
    assert clock.judge(50 * MS, 0) is Due.STALE


def test_a_run_that_was_announced_begins_with_its_first_tick() -> None:
    """Also where the step does not divide a second, so that the tick begins before the run."""
    clock = TickClock(30 * MS)
    clock.timeline.announce(0, 0)
    clock.judge(0, 0)
    clock.planned(0)
    clock.timeline.announce(1, 2000 * MS)
    assert clock.judge(30 * MS, 0) is Due.PLAN
    assert clock.judge(1980 * MS, 1) is Due.PLAN
    assert clock.new_epoch
    assert clock.epoch == 1
    assert clock.timeline.start_ns == 2000 * MS
    assert clock.judge(30 * MS, 0) is Due.STALE


def _timed(known_from: float | None, contact: str = "foot") -> ContactSchedule:
    return ContactSchedule.checked(contact, [9.0], [0.0], [1.0], known_from=known_from)


def test_schedules_wait_until_they_are_known_in_that_order() -> None:
    inbox = ScheduleInbox(lockstep=False)
    assert not inbox.put(_timed(3.0, "c"), 0.0, False)
    assert not inbox.put(_timed(2.0, "b"), 0.0, False)
    assert inbox.put(_timed(None, "a"), 0.0, False)
    assert [s.name for s in inbox.due(0.0)] == ["a"]
    assert inbox.due(1.99) == []
    assert [s.name for s in inbox.due(3.0)] == ["b", "c"]
    assert inbox.due(9.0) == []


@pytest.mark.parametrize("known", [None, 1.0, 2.0])
def test_in_lockstep_nothing_may_depend_on_its_arrival(known: float | None) -> None:
    inbox = ScheduleInbox(lockstep=True)
    inbox.put(_timed(known), 0.0, False)
    assert not inbox.put(_timed(2.5), 2.0, True)
    with pytest.raises(InvalidValue, match=r"contact 'foot'.*later than 2 s \(now\) expected"):
        inbox.put(_timed(known), 2.0, True)
    ScheduleInbox(lockstep=False).put(_timed(known), 2.0, True)

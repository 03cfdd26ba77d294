"""Ticks of the generators: each announced once, in time, and again for who waits."""

from __future__ import annotations

import pytest

from ghc_controller.ros.wire.ticks import TickAnnouncer

MS = 1_000_000  # [ns]
TICK = 10 * MS


def _run(period: int, stop: int) -> dict[int, int]:
    """Tick -> stamp of the state around which it was announced, of a run without repeats."""
    announcer = TickAnnouncer(period, TICK)
    found: dict[int, int] = {}
    for stamp in range(0, stop, period):
        for tick in (announcer.on_state(stamp, 0), announcer.on_answer(stamp, 0)):
            if tick is not None:
                assert tick not in found
                found[tick] = stamp
    return found


@pytest.mark.parametrize(("period", "lead"), [(1, 5), (2, 4), (5, 5), (10, 10)])
def test_every_tick_once_and_half_a_tick_ahead(period: int, lead: int) -> None:
    """The first one, and what follows the first state, when they are there."""
    found = _run(period * MS, 200 * MS)
    assert sorted(found) == list(range(0, max(found) + 1, TICK))
    ahead = {tick: tick - stamp for tick, stamp in found.items() if stamp > 0}
    first = min(ahead)
    assert all(head == lead * MS for tick, head in ahead.items() if tick > first)
    assert ahead[first] in (0, lead * MS)


def test_nothing_is_announced_ahead_of_the_first_state() -> None:
    announcer = TickAnnouncer(TICK, TICK)
    assert announcer.on_state(0, 0) == 0
    for _ in range(3):
        assert announcer.on_answer(0, 0) is None
        assert announcer.on_state(0, 0) == 0  # a repeat: somebody may wait for its plan


def test_a_state_that_comes_again_is_announced_again_only_where_its_plan_is_the_newest() -> None:
    announcer = TickAnnouncer(MS, TICK)
    announcer.on_state(0, 0)
    announcer.on_state(MS, 0)
    assert announcer.on_answer(MS, 0) is None
    assert announcer.on_state(5 * MS, 0) is None
    assert announcer.on_answer(5 * MS, 0) == TICK
    assert announcer.on_state(5 * MS, 0) is None  # answered from the plan before
    assert announcer.on_state(TICK, 0) is None
    assert announcer.on_state(TICK, 0) == TICK


def test_a_new_epoch_starts_again() -> None:
    announcer = TickAnnouncer(MS, TICK)
    for stamp in range(0, 50 * MS, MS):
        announcer.on_state(stamp, 0)
        announcer.on_answer(stamp, 0)
    assert announcer.on_state(0, 1) == 0
    assert announcer.on_answer(0, 1) is None
    assert announcer.on_state(MS, 1) is None


@pytest.mark.parametrize("epoch", [0, 4, 5])
def test_a_robot_that_starts_again_has_its_ticks_from_the_start(epoch: int) -> None:
    """A restarted bridge counts its epochs and its time from 0, whatever they were before."""
    announcer = TickAnnouncer(MS, TICK)
    for stamp in range(0, 50 * MS, MS):
        announcer.on_state(stamp, 5)
        announcer.on_answer(stamp, 5)
    assert announcer.on_state(0, epoch) == 0
    assert announcer.on_answer(0, epoch) is None  # its first state
    announced = []
    for stamp in range(MS, 30 * MS, MS):
        announced += [announcer.on_state(stamp, epoch), announcer.on_answer(stamp, epoch)]
    assert [tick for tick in announced if tick is not None] == [TICK, 2 * TICK, 3 * TICK]


def test_states_that_were_missed_do_not_hide_a_tick() -> None:
    announcer = TickAnnouncer(MS, TICK)
    announcer.on_state(0, 0)
    assert announcer.on_state(37 * MS, 0) == 30 * MS
    assert announcer.on_answer(37 * MS, 0) == 40 * MS

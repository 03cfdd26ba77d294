"""A clock of another host is believed by several times that go on, and given up in the end."""

from __future__ import annotations

import pytest

from ghc_sim_bridge.run.heard_clock import IN_A_ROW, PATIENCE, SILENCE, HeardClock

SECOND = 1_000_000_000
FORGED = (10**6 * SECOND, 2**31 * SECOND)


class Wall:
    """Wall time that a test moves."""

    now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.mark.parametrize("stamp", FORGED)
def test_a_forged_time_changes_nothing_however_often_it_is_repeated(stamp: int) -> None:
    clock = HeardClock(Wall())
    for step in range(100):
        own = step * SECOND // 100
        assert not clock.hear(stamp, own)
        assert not clock.hear(own, own), "its own message, in between"
    assert clock.time_ns == -1
    assert clock.leaves_to(0)


def test_a_clock_that_goes_on_ahead_is_believed_and_followed() -> None:
    wall = Wall()
    clock = HeardClock(wall)
    heard = [clock.hear(5 * SECOND + k * SECOND // 100, k * SECOND // 100) for k in range(50)]
    assert heard.index(True) == IN_A_ROW - 1
    assert heard.count(True) == 1
    newest = clock.time_ns
    clock.hear(FORGED[0], SECOND)
    assert clock.time_ns == newest, "a forged time between true ones"
    assert not clock.leaves_to(SECOND)


def test_the_clock_of_one_that_is_behind_is_ignored() -> None:
    clock = HeardClock(Wall())
    assert not any(clock.hear(k * SECOND, (k + 3) * SECOND) for k in range(50))


def test_a_silent_clock_is_left_to_one_that_is_ahead_and_then_to_anybody() -> None:
    wall = Wall()
    clock = HeardClock(wall)
    for k in range(IN_A_ROW):  # all of them forged: the worst case
        clock.hear(FORGED[0] + k, 0)
    assert clock.time_ns > 0
    wall.now += SILENCE + 0.1
    assert clock.leaves_to(FORGED[0] + SECOND)
    assert not clock.leaves_to(SECOND)
    wall.now += PATIENCE
    assert clock.leaves_to(SECOND)


def test_another_run_of_the_same_host_is_followed() -> None:
    clock = HeardClock(Wall())
    for k in range(1, 20):
        clock.hear(100 * SECOND + k, 0)
    for k in range(1, IN_A_ROW + 1):
        clock.hear(k * SECOND // 10, 2 * SECOND)
    assert clock.time_ns == IN_A_ROW * SECOND // 10

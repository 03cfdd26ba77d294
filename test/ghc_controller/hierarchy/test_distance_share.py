"""Priorities that follow a distance, through a schedule of ramps that replace each other."""

from __future__ import annotations

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy import TransitionSchedule
from ghc_controller.hierarchy.distance_share import DistanceShare, Move, ShareFollower

TASKS = ("hand", "elbow", "posture")
FIRST, SECOND = (
    ghc.matrix_from_hierarchy(TASKS, text)
    for text in ("hand > elbow > posture", "elbow > posture")
)
SHARE = DistanceShare(0.01, 0.035)


def _run(values: np.ndarray, delay: int = 3, period: int = 10) -> tuple[np.ndarray, int]:
    """(T,) share at each ms while the value is values[k]; requests come `delay` ms later."""
    schedule = TransitionSchedule(FIRST, lambda _: 1.0)
    follower, shares, requests = ShareFollower(SHARE), [], 0
    waiting: list[tuple[int, Move]] = []
    for k, value in enumerate(values):
        now = 1e-3 * k
        while waiting and waiting[0][0] <= k:
            due = waiting.pop(0)[1]
            target = SECOND if due.to_second else FIRST
            transition = ghc.Transition(target, now, due.duration, ghc.Profile.LINEAR)
            if not schedule.is_repeat(transition):
                schedule.add(transition, now)
                requests += 1
        schedule.advance(now)
        candidates = schedule.in_force.candidates
        share = sum(c.share for c in candidates if np.array_equal(c.alpha, SECOND.alpha))
        shares.append(share)
        if k % period == 0 and (move := follower.next(share, value)) is not None:
            waiting.append((k + delay, move))
    return np.array(shares), requests


@pytest.mark.parametrize("delay", [1, 8, 15])
def test_the_share_follows_and_comes_back(delay: int) -> None:
    """Near and away again within 3 s: late by 20 to 50 ms, at both ends exactly."""
    time = np.linspace(0.0, 3.0, 3001)
    values = 0.04 * np.sin(np.pi * np.clip((time - 0.3) / 2.0, 0.0, 1.0)) ** 2
    shares, _ = _run(values, delay)
    wanted = np.array([SHARE.wanted(value) for value in values])
    apart = min(np.abs(shares[late:] - wanted[:-late]).max() for late in range(20, 50))
    assert apart < 0.03
    assert shares.max() == 1.0
    assert shares[-1] == 0.0
    assert np.abs(np.diff(shares)).max() <= 1e-3 / SHARE.full_way + 1e-12


def test_a_value_that_stands_asks_for_nothing() -> None:
    """In the middle one ramp holds the share; at an end nothing is sent, as before the first."""
    shares, requests = _run(np.full(2000, 0.02))
    assert abs(shares[-1] - SHARE.wanted(0.02)) < 2e-3
    assert requests < 40
    ends, count = _run(np.concatenate([np.zeros(500), np.full(1000, 0.1)]))
    assert count == 1
    assert ends[-1] == 1.0
    assert not ends[:500].any()


def test_the_direction_of_the_value_does_not_matter() -> None:
    """A distance that falls from 70 to 45 mm is an error that grows from 10 to 35 mm."""
    falling = DistanceShare(0.07, 0.045)
    for gap in np.linspace(0.03, 0.08, 11):
        assert falling.wanted(gap) == pytest.approx(SHARE.wanted(0.08 - gap), abs=1e-12)


@pytest.mark.parametrize("values", [(0.01, 0.01), (np.nan, 1.0), (0.0, 1.0, 0.0), (0, 1, 0.1, -1)])
def test_what_cannot_be_is_rejected(values: tuple[float, ...]) -> None:
    with pytest.raises(InvalidValue):
        DistanceShare(*values)

"""Priorities as mixtures of orders: ramps, pre-emption, torque-rate budgets."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ghc_controller.errors import GhcError
from ghc_controller.hierarchy import (
    Candidate,
    Priorities,
    PriorityMatrix,
    Profile,
    Transition,
    TransitionPhase,
    TransitionSchedule,
    matrix_from_hierarchy,
)
from ghc_controller.hierarchy.levels import is_order, levels
from ghc_controller.hierarchy.ramp import MOST_CANDIDATES, PacedPriorities, Ramp
from ghc_controller.types import Array

TASKS = ("a", "b", "c", "d")
PERIOD = 1e-3  # [s]


def _matrix(order: tuple[str, ...]) -> PriorityMatrix:
    return matrix_from_hierarchy(TASKS, " > ".join(order))


def _schedule() -> TransitionSchedule:
    return TransitionSchedule(_matrix(TASKS), lambda _: 1.0)


ORDERS = [_matrix(order) for order in itertools.permutations(TASKS)]


def test_alpha_is_the_mixture_of_accepted_targets() -> None:
    """60 pre-empting ramps: alpha = sum of shares times targets, shares add up to 1. Seed 3."""
    rng = np.random.default_rng(3)
    schedule, time = _schedule(), 0.0
    known = {ORDERS[0].alpha.tobytes()}
    for _ in range(60):
        target = ORDERS[rng.integers(len(ORDERS))]
        known.add(target.alpha.tobytes())
        schedule.add(Transition(target, time, 0.3, Profile.COSINE), time)
        for _ in range(int(rng.integers(1, 12))):
            time += 0.02
            schedule.advance(time)
            in_force = schedule.in_force
            shares = [candidate.share for candidate in in_force.candidates]
            total = sum(candidate.share * candidate.alpha for candidate in in_force.candidates)
            assert np.isclose(sum(shares), 1.0, rtol=0, atol=1e-12)
            assert np.abs(total - in_force.alpha).max() < 1e-12
            assert {candidate.alpha.tobytes() for candidate in in_force.candidates} <= known
            assert len(shares) <= MOST_CANDIDATES


def _share_of(candidates: tuple[Candidate, ...], alpha: Array) -> float:
    return sum(c.share for c in candidates if np.array_equal(c.alpha, alpha))


def test_nested_pre_emptions_never_make_a_share_jump() -> None:
    """A crowded ramp lets the smallest share go first: no share moves faster than 4/3 a ramp."""
    rng = np.random.default_rng(4)
    schedule, time, steps = _schedule(), 0.0, 100
    before = schedule.in_force.candidates
    for _ in range(40):
        schedule.add(
            Transition(ORDERS[rng.integers(len(ORDERS))], time, 1.0, Profile.LINEAR), time
        )
        for _ in range(30):
            time += 1.0 / steps
            schedule.advance(time)
            now = schedule.in_force.candidates
            for matrix in ORDERS:
                moved = abs(_share_of(now, matrix.alpha) - _share_of(before, matrix.alpha))
                assert moved <= 4.0 / 3.0 / steps + 1e-9
            before = now


def test_entries_that_all_targets_share_stay_exact() -> None:
    """An entry of 1 in every target is 1 in the mixture: it removes a task, or keeps a tie."""
    start, goal = _matrix(("a", "b", "c")), _matrix(("c", "b", "a"))
    ramp = Ramp((Candidate(start.alpha, 1.0),), goal.alpha)
    schedule = TransitionSchedule(start, lambda _: 1.0)
    schedule.add(Transition(goal, 0.0, 1.0), 0.0)
    for time in np.linspace(0.0, 1.0, 57):
        schedule.advance(float(time))
        assert np.array_equal(schedule.alpha[3], np.ones(4))
    assert ramp.part_end(0.0) == 1.0


def _walk(budget: float, duration: float, torques: list[Array]) -> tuple[list[float], list[str]]:
    """Progress per step of a ramp between two constant answers, and the phases it went through."""
    schedule = _schedule()
    schedule.add(Transition(ORDERS[5], 0.0, duration, Profile.LINEAR, torque_rate=budget), 0.0)
    way, phases = [], []
    for tick in range(10000):
        now = tick * PERIOD
        phases += [event.phase.name for event in schedule.advance(now)]
        priorities = schedule.pace(now, PERIOD)
        if not isinstance(priorities, PacedPriorities):
            break
        progress = priorities.progress(torques)
        way.append(progress)
        phases += [event.phase.name for event in schedule.settle(progress, now)]
    return way, phases


def test_a_budget_sets_the_duration() -> None:
    """20 Nm apart at 100 Nm/s and 1 ms: 200 steps of 0.1 Nm, and DONE at the last one."""
    way, phases = _walk(100.0, 0.0, [np.array([1.0, -2.0]), np.array([6.0, 18.0])])
    assert len(way) == 200
    assert np.allclose(np.diff([0.0, *way]), 1.0 / 200, atol=1e-12)
    assert phases == ["ACTIVE", "DONE"]


def test_the_slower_of_budget_and_duration_counts() -> None:
    """A loose budget leaves the duration, a tight one outlasts it."""
    apart = [np.zeros(2), np.array([0.0, 20.0])]
    assert len(_walk(1e4, 0.5, apart)[0]) == pytest.approx(501, abs=1)
    assert len(_walk(100.0, 0.05, apart)[0]) == pytest.approx(200, abs=2)


def test_a_budget_holds_through_pre_emption() -> None:
    """Random answers that move, targets that change mid-way: no step adds more. Seed 6."""
    rng = np.random.default_rng(6)
    answers = {matrix.alpha.tobytes(): rng.normal(size=7) * 30.0 for matrix in ORDERS}
    schedule, finished = _schedule(), 0
    for tick in range(20000):
        now = tick * PERIOD
        if tick % 450 == 0:
            target = ORDERS[rng.integers(len(ORDERS))]
            schedule.add(Transition(target, now, 0.0, torque_rate=200.0), now)
        for answer in answers.values():
            answer += 0.05 * rng.normal(size=7)
        schedule.advance(now)
        priorities = schedule.pace(now, PERIOD)
        if not isinstance(priorities, PacedPriorities):
            continue
        torques = [answers[candidate.alpha.tobytes()] for candidate in priorities.candidates]
        progress = priorities.progress(torques)
        begin = np.array([candidate.share for candidate in priorities.candidates])
        moved = (priorities.shares_at(progress) - begin) @ np.array(torques)
        assert np.abs(moved).max() <= 200.0 * PERIOD * (1.0 + 1e-9)
        events = schedule.settle(progress, now)
        finished += sum(event.phase is TransitionPhase.DONE for event in events)
    assert finished > 20


def test_answers_that_are_not_finite_stop_the_ramp() -> None:
    """The share stays where it is."""
    ramp = Ramp((Candidate(ORDERS[0].alpha, 1.0),), ORDERS[1].alpha)
    priorities = PacedPriorities.on(ramp, 0.25, 1.0, 0.1)
    assert priorities.progress([np.zeros(2), np.full(2, np.nan)]) == 0.25


@pytest.mark.parametrize("rate", [-1.0, np.nan, np.inf])
def test_bad_torque_rate(rate: float) -> None:
    """The message says what was given."""
    with pytest.raises(GhcError, match="torque_rate"):
        Transition(ORDERS[0], 0.0, 1.0, torque_rate=rate)


def test_orders_are_told_from_other_matrices() -> None:
    """Strings give orders; compromises across levels, cycles and one-sided ties do not."""
    for text in ("a > b > c > d", "a = b > c", "d", "b > a = c = d"):
        assert is_order(matrix_from_hierarchy(TASKS, text).alpha)
    assert levels(matrix_from_hierarchy(TASKS, "b > a = c").alpha) == [[1], [0, 2]]
    cycle = np.zeros((3, 3))
    cycle[1, 0] = cycle[2, 1] = cycle[0, 2] = 1.0
    part = matrix_from_hierarchy(TASKS, "a > b > c > d").alpha.copy()
    part[3, 0] = 0.8
    one_sided = np.zeros((2, 2))
    one_sided[0, 1] = 0.3
    leaving = np.zeros((2, 2))
    leaving[1, 0], leaving[1, 1] = 1.0, 0.4
    for alpha in (cycle, part, one_sided, leaving):
        assert not is_order(alpha)


@pytest.mark.parametrize("profile", list(Profile))
def test_a_ramp_that_is_done_is_done(profile: Profile) -> None:
    """One candidate is left, whatever the rounding of start + duration: 2000 pairs, seed 8."""
    rng = np.random.default_rng(8)
    for start, duration in np.round(rng.uniform(0.0, 3.0, size=(2000, 2)), 3):
        schedule = _schedule()
        schedule.add(Transition(ORDERS[5], float(start), float(duration), profile), 0.0)
        schedule.advance(float(start))
        schedule.advance(float(start) + 0.5 * float(duration))
        for candidate in schedule.in_force.candidates:
            assert 0.0 <= candidate.share <= 1.0
        schedule.advance(float(start) + float(duration))
        schedule.advance(10.0)
        assert [candidate.share for candidate in schedule.in_force.candidates] == [1.0]
        assert np.array_equal(schedule.alpha, ORDERS[5].alpha)


def test_a_budget_is_spent_once_per_time() -> None:
    """A state that is answered again goes from where the ramp stood at that time."""
    rng = np.random.default_rng(2)
    answers = [rng.normal(size=7), rng.normal(size=7)]
    schedule = _schedule()
    schedule.add(Transition(ORDERS[5], 0.0, 0.0, torque_rate=100.0), 0.0)
    progress = []
    for time in (0.0, 0.0, 0.0, PERIOD, PERIOD, 2 * PERIOD):
        schedule.advance(time)
        paced = schedule.pace(time, PERIOD)
        assert isinstance(paced, PacedPriorities)
        schedule.settle(paced.progress(answers), time)
        progress.append(schedule.in_force.candidates[-1].share)
    assert progress[0] > 0.0
    assert progress == pytest.approx([progress[0] * n for n in (1, 1, 1, 2, 2, 3)], rel=1e-12)


@pytest.mark.parametrize(
    "change", [{"torque_rate": 10.0}, {"duration": 1.0}, {"profile": Profile.LINEAR}]
)
def test_another_ramp_to_the_same_target_is_no_repeat(change: dict[str, Any]) -> None:
    schedule = _schedule()
    first = Transition(ORDERS[5], 0.0, 2.0)
    schedule.add(first, 0.0)
    assert schedule.is_repeat(first)
    assert not schedule.is_repeat(replace(first, **change))
    schedule.advance(0.5)
    assert schedule.is_repeat(replace(first, start=0.5))
    assert not schedule.is_repeat(replace(first, start=0.5, **change))
    schedule.advance(2.0)
    assert schedule.is_repeat(replace(first, start=2.0, **change))  # the target is active


def _held(share: float) -> Priorities:
    pairs = ((ORDERS[0].alpha, 1.0 - share), (ORDERS[5].alpha, share))
    return Priorities.mixed(Candidate(*pair) for pair in pairs if pair[1] > 0.0)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_held_priorities_are_in_force_until_a_transition_starts(share: float) -> None:
    """For every reader alike; a ramp that ran is left, and the next one begins at them."""
    schedule = _schedule()
    schedule.add(Transition(ORDERS[7], 0.0, 1.0), 0.0)
    schedule.advance(0.5)
    events = schedule.hold(_held(share), 0.5)
    assert [event.phase for event in events] == [TransitionPhase.PREEMPTED]
    for time in (0.5, 0.6, 2.0):
        assert schedule.advance(time) == []
        matrices, shares = schedule.mixture
        found = list(zip(matrices, shares, strict=True))
        wanted = _held(share).candidates
        for one in (found, schedule.in_force.candidates, schedule.pace(time, PERIOD).candidates):
            np.testing.assert_array_equal([each[0] for each in one], [c.alpha for c in wanted])
            assert [each[1] for each in one] == pytest.approx([c.share for c in wanted])
        assert np.abs(schedule.alpha - _held(share).alpha).max() < 1e-12
    back = Transition(ORDERS[0], 2.0, 1.0)
    assert schedule.is_repeat(back) == (share == 0.0)
    schedule.add(back, 2.0)
    schedule.advance(2.0)
    assert np.abs(schedule.alpha - _held(share).alpha).max() < 1e-12
    schedule.advance(3.0)
    assert np.array_equal(schedule.alpha, ORDERS[0].alpha)

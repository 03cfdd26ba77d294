"""No single message hides the run under way, and a run that is real is followed soon."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.ros.synchronizer import StateGate, Verdict
from ghc_controller.ros.wire.timeline import CONFIRMATIONS, MOST_AHEAD_NS, SILENCE, Place, Timeline

MS = 1_000_000  # [ns]
FOREVER = 2**31 * 1_000_000_000  # [ns]
FORGED = [
    (3600_000 * MS, 0),
    (10 * MS, 1),
    (10 * MS, 999_999),
    (FOREVER, 0),
    (-FOREVER, 10**6),
    (0, 0),
]


class Run:
    """A timeline fed at 1 kHz of wall time."""

    def __init__(self) -> None:
        self.wall = 0.0
        self.timeline = Timeline(clock=lambda: self.wall)

    def feed(self, first_ms: int, count: int, epoch: int = 0) -> list[Place]:
        """States of `count` periods from `first_ms` on, as fast as time goes."""
        places = []
        for k in range(count):
            self.wall += 1e-3
            places.append(self.timeline.judge((first_ms + k) * MS, epoch))
        return places


@pytest.mark.parametrize("copies", [1, 5, 40])
@pytest.mark.parametrize(("stamp", "epoch"), FORGED)
def test_a_forged_stamp_is_not_believed_and_changes_nothing(
    stamp: int, epoch: int, copies: int
) -> None:
    """However many copies come between two true states."""
    run = Run()
    assert set(run.feed(1000, 100)) == {Place.NEXT}
    for _ in range(copies):
        assert run.timeline.judge(stamp, epoch) in (Place.OLDER, Place.ELSEWHERE)
    assert set(run.feed(1100, 100)) == {Place.NEXT}


@pytest.mark.parametrize(("stamp", "epoch"), FORGED)
def test_a_forged_first_stamp_costs_less_than_a_tenth_of_a_second(stamp: int, epoch: int) -> None:
    run = Run()
    run.timeline.judge(stamp, epoch)
    places = run.feed(500, 100)
    begun = next(k for k, place in enumerate(places) if place in (Place.RESTARTED, Place.RESUMED))
    assert begun < 60
    assert set(places[begun + 1 :]) == {Place.NEXT}


def test_a_forged_stamp_a_little_ahead_hides_the_run_for_less_than_a_tenth_of_a_second() -> None:
    run = Run()
    run.feed(0, 100)
    assert run.timeline.judge(100 * MS + MOST_AHEAD_NS - MS, 0) is Place.NEXT
    places = run.feed(100, 200)
    assert places.index(Place.RESUMED) < 60
    assert Place.RESTARTED not in places


@pytest.mark.parametrize(
    ("first_ms", "epoch", "expected"),
    [(0, 1, Place.RESTARTED), (0, 0, Place.RESTARTED), (40_000, 0, Place.RESUMED)],
)
def test_a_reset_a_restarted_bridge_and_a_cut_link_are_followed(
    first_ms: int, epoch: int, expected: Place
) -> None:
    run = Run()
    run.feed(5000, 100)
    run.wall += SILENCE
    places = run.feed(first_ms, 20, epoch)
    assert places[CONFIRMATIONS - 1] is expected
    assert set(places[CONFIRMATIONS:]) == {Place.NEXT}


def test_random_forgeries_at_the_rate_of_the_run_never_win() -> None:
    """5000 true states, each with up to three random others after it (seed 4)."""
    rng = np.random.default_rng(4)
    run = Run()
    for k in range(5000):
        assert run.feed(k, 1) == [Place.NEXT]
        for _ in range(rng.integers(4)):
            stamp = int(rng.integers(-FOREVER, FOREVER)) if rng.random() < 0.5 else 7_200_000 * MS
            run.timeline.judge(stamp, int(rng.integers(3)))


def test_the_gate_answers_the_true_states_around_a_forged_one() -> None:
    gate: StateGate[str] = StateGate(())
    for k in range(5):
        assert gate.state("true", k * MS, "0") is Verdict.NEW
        gate.answered(k * MS)
        assert gate.state("forged", 3600_000 * MS, "0") is Verdict.IMPLAUSIBLE
        assert gate.state("forged", 0, "999999") is Verdict.IMPLAUSIBLE
    assert gate.state("true", 4 * MS, "0") is Verdict.REPEATED


@pytest.mark.parametrize("companions", [(), ("odom",)])
def test_a_run_begins_with_the_first_of_its_states_that_is_answered(
    companions: tuple[str, ...],
) -> None:
    """Those before it were refused, by a joint outside its limits for example."""
    wall = 0.0
    gate: StateGate[str] = StateGate(companions, timeline=Timeline(clock=lambda: wall))

    def state(stamp_ns: int, epoch: str) -> Verdict:
        verdict = gate.state("state", stamp_ns, epoch)
        for name in companions:
            assert verdict is Verdict.WAITING
            completed = gate.companion(name, stamp_ns, np.zeros(13))
            assert completed is not None
            verdict = completed[1]
        return verdict

    assert state(MS, "0") is Verdict.NEW
    gate.answered(MS)
    wall = SILENCE
    for _ in range(CONFIRMATIONS - 1):
        assert gate.state("state", 0, "1") is Verdict.IMPLAUSIBLE
    for k in range(3):
        assert state(k * MS, "1") is Verdict.NEW_EPOCH
        gate.forget()  # refused
    gate.answered(2 * MS)
    assert state(3 * MS, "1") is Verdict.NEW


@pytest.mark.parametrize("epoch", [0, 1, 2])
def test_a_run_does_not_begin_on_a_plan_of_the_one_before(epoch: int) -> None:
    """Whatever its epoch and its time are."""
    wall = 0.0
    gate: StateGate[str] = StateGate((), ("plan",), 10 * MS, Timeline(clock=lambda: wall))
    gate.state("state", 5000 * MS, "1")
    assert gate.plan("plan", 5000 * MS, 1) is not None
    gate.answered(5000 * MS)
    wall = SILENCE
    places = [gate.state("state", 0, str(epoch)) for _ in range(CONFIRMATIONS)]
    assert places[-1] is Verdict.WAITING
    assert gate.plan("plan", 0, epoch) == ("state", Verdict.NEW_EPOCH)

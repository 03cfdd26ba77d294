"""No single message hides the run under way, and a run that is real is followed soon."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.ros.wire.synchronizer import StateDisposition, StateGate
from ghc_controller.ros.wire.timeline import CONFIRMATIONS, MOST_AHEAD_NS, SILENCE, Place, Timeline

MS = 1_000_000  # [ns]
FOREVER = 2**31 * 1_000_000_000  # [ns]
FORGED: list[tuple[int, int | None]] = [
    (3600_000 * MS, 0),
    (3600_000 * MS, None),
    (10 * MS, 1),
    (10 * MS, 999_999),
    (FOREVER, 0),
    (-FOREVER, 10**6),
    (-FOREVER, None),
    (0, 0),
    (0, None),
]
ANNOUNCED = [(1, 0), (0, 0), (10**18, 3600_000 * MS), (1, 1050 * MS), (7, -FOREVER), (1, FOREVER)]


class Run:
    """A timeline fed at 1 kHz of wall time."""

    def __init__(self) -> None:
        self.wall = 0.0
        self.timeline = Timeline(clock=lambda: self.wall)

    def feed(self, first_ms: int, count: int, epoch: int | None = 0) -> list[Place]:
        """States of `count` periods from `first_ms` on, as fast as time goes."""
        places = []
        for k in range(count):
            self.wall += 1e-3
            places.append(self.timeline.judge((first_ms + k) * MS, epoch))
        return places


@pytest.mark.parametrize("copies", [1, 5, 40])
@pytest.mark.parametrize(("stamp", "epoch"), FORGED)
def test_a_forged_stamp_is_not_believed_and_changes_nothing(
    stamp: int, epoch: int | None, copies: int
) -> None:
    """However many copies come between two true states."""
    run = Run()
    assert set(run.feed(1000, 100)) == {Place.NEXT}
    for _ in range(copies):
        assert run.timeline.judge(stamp, epoch) in (Place.OLDER, Place.ELSEWHERE)
    assert set(run.feed(1100, 100)) == {Place.NEXT}


@pytest.mark.parametrize(("stamp", "epoch"), FORGED)
def test_a_forged_first_stamp_costs_less_than_a_tenth_of_a_second(
    stamp: int, epoch: int | None
) -> None:
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
        assert gate.state("true", k * MS) is StateDisposition.NEW
        gate.answered(k * MS)
        assert gate.state("forged", 3600_000 * MS) is StateDisposition.IMPLAUSIBLE
        assert gate.state("forged", -1) is StateDisposition.STALE
    assert gate.state("true", 4 * MS) is StateDisposition.REPEATED


@pytest.mark.parametrize("companions", [(), ("odom",)])
def test_a_run_begins_with_the_first_of_its_states_that_is_answered(
    companions: tuple[str, ...],
) -> None:
    """Those before it were rejected, by a joint outside its limits for example."""
    gate: StateGate[str] = StateGate(companions)
    start = 2000 * MS

    def state(stamp_ns: int) -> StateDisposition:
        disposition = gate.state("state", stamp_ns)
        for name in companions:
            assert disposition is StateDisposition.WAITING
            completed = gate.companion(name, stamp_ns, np.zeros(13))
            assert completed is not None
            disposition = completed[1]
        return disposition

    assert state(MS) is StateDisposition.NEW
    gate.answered(MS)
    assert gate.state("state", start) is StateDisposition.IMPLAUSIBLE  # not announced yet
    gate.timeline.announce(1, start)
    for k in range(3):
        assert state(start + k * MS) is StateDisposition.NEW_EPOCH
        gate.forget()  # rejected
    gate.answered(start + 2 * MS)
    assert state(start + 3 * MS) is StateDisposition.NEW


def test_companions_with_forged_stamps_do_not_hide_the_true_one() -> None:
    """Several between the companion of a state and the state, before and behind it."""
    gate: StateGate[str] = StateGate(("odom",))
    for k in range(50):
        gate.companion("odom", k * MS, np.full(13, float(k)))
        for stamp in (-1, k * MS + 3600_000 * MS, 2**62):
            assert gate.companion("odom", stamp + k, np.full(13, -1.0)) is None
        assert gate.state("true", k * MS) is StateDisposition.NEW
        assert gate.companions_of(k * MS)["odom"][0] == k
        gate.answered(k * MS)
    assert gate.state("true", 50 * MS) is StateDisposition.WAITING
    assert gate.companions_of(50 * MS) == {}


@pytest.mark.parametrize(("epoch", "start_ms"), [(0, 0), (1, 0), (2, 7000)])
def test_a_run_does_not_begin_on_a_plan_of_the_one_before(epoch: int, start_ms: int) -> None:
    """Whether the bridge was reset or started again."""
    gate: StateGate[str] = StateGate((), ("plan",), 10 * MS)
    gate.timeline.announce(1, 4000 * MS)
    gate.state("state", 5000 * MS)
    assert gate.plan("plan", 5000 * MS, 1) is not None
    gate.answered(5000 * MS)
    gate.timeline.announce(epoch, start_ms * MS)
    assert gate.state("state", start_ms * MS) is StateDisposition.WAITING
    assert gate.epoch == epoch
    assert gate.plan("plan", start_ms * MS, epoch) == ("state", StateDisposition.NEW_EPOCH)


@pytest.mark.parametrize(("number", "start_ns"), ANNOUNCED)
def test_a_forged_announcement_changes_nothing(number: int, start_ns: int) -> None:
    """Also one of a run that would begin among the next states of the true one."""
    run = Run()
    run.timeline.announce(0, 0)
    run.feed(0, 1000, None)
    run.timeline.announce(number, start_ns)
    assert set(run.feed(1000, 200, None)) == {Place.NEXT}
    assert (run.timeline.epoch, run.timeline.start_ns) == (0, 0)


@pytest.mark.parametrize("known", [True, False])
def test_an_announced_run_begins_with_its_first_state(known: bool) -> None:
    """Also where those of the first run were heard before its announcement came."""
    run = Run()
    if known:
        run.timeline.announce(3, 7000 * MS)
    run.feed(7000, 10, None)
    run.timeline.announce(3, 7000 * MS)
    assert run.timeline.epoch == 3
    run.timeline.announce(4, 9000 * MS)
    assert run.timeline.is_of_next_run(9000 * MS)
    assert not run.timeline.is_of_next_run(8999 * MS)
    assert set(run.feed(7010, 10, None)) == {Place.NEXT}
    assert run.feed(9000, 3, None) == [Place.RESTARTED, Place.NEXT, Place.NEXT]
    assert (run.timeline.epoch, run.timeline.start_ns) == (4, 9000 * MS)
    assert run.timeline.is_stale(8999 * MS)
    assert not run.timeline.is_stale(9000 * MS)
    assert set(run.feed(7030, 5, None)) == {Place.OLDER}


def test_only_the_last_of_many_resets_is_followed() -> None:
    run = Run()
    run.timeline.announce(0, 0)
    run.feed(0, 10, None)
    for k in range(1, 101):
        run.timeline.announce(k, 2000 * k * MS)
    assert run.timeline.judge(2000 * 50 * MS) is Place.ELSEWHERE
    assert run.feed(2000 * 100, 2, None) == [Place.RESTARTED, Place.NEXT]
    assert run.timeline.epoch == 100


def test_a_restarted_bridge_is_followed_at_its_announcement() -> None:
    """Its time is back at zero, and its first run has the number of the one before."""
    run = Run()
    run.timeline.announce(0, 0)
    run.feed(0, 500, None)
    assert run.feed(0, 1, None) == [Place.OLDER]
    run.timeline.announce(0, 0)
    assert run.feed(0, 3, None) == [Place.RESTARTED, Place.NEXT, Place.NEXT]

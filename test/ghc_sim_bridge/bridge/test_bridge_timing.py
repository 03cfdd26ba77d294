"""When the bridge steps, repeats, holds and gives up; times are given, nothing waits."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.safety.torque_gate import TorqueGate
from ghc_sim_bridge.bridge.lockstep import REPEAT_PERIOD, Due, Lockstep, PartnerMissing
from ghc_sim_bridge.bridge.patient_publishing import patient
from ghc_sim_bridge.bridge.realtime import FRESH_COMMANDS_TO_RESUME, MAX_CATCH_UP, Pacer, Watchdog
from ghc_sim_bridge.recorder.decimation import Decimator
from ghc_sim_bridge.recorder.timeline import PATIENCE_NS, RecordingTimeline

MS = 1_000_000  # [ns]


def test_lockstep_repeats_then_gives_up() -> None:
    lockstep = Lockstep(timeout=1.0, now=0.0)
    lockstep.sent(5 * MS, now=10.0)
    assert lockstep.due(10.0 + 0.9 * REPEAT_PERIOD) is Due.NOTHING
    assert lockstep.due(10.0 + 1.1 * REPEAT_PERIOD) is Due.REPEAT
    lockstep.repeated(10.1)
    assert lockstep.due(10.1 + 0.9 * REPEAT_PERIOD) is Due.NOTHING
    assert lockstep.due(11.01) is Due.GIVE_UP, "a repeat does not move the deadline"
    assert lockstep.awaited_ns == 5 * MS


def test_lockstep_waits_for_ever_while_nobody_is_late() -> None:
    lockstep = Lockstep(timeout=1.0, now=0.0)
    for now in np.arange(0.0, 10.0, 0.5):
        lockstep.keep_waiting(float(now))
        assert lockstep.due(float(now)) is not Due.GIVE_UP


def test_missing_partner_says_which_state_and_why() -> None:
    lockstep = Lockstep(timeout=1.0, now=0.0)
    lockstep.sent(1234 * MS, now=0.0)
    asked = str(lockstep.missing("joint_commands", 2, 1.5, ""))
    assert "'joint_commands'" in asked and "t = 1.234000 s (epoch 2)" in asked
    assert "controller running" in asked
    refused = str(lockstep.missing("joint_commands", 2, 1.5, "effort: joint_3 is nan"))
    assert "rejected: effort: joint_3 is nan" in refused


def test_pacer_keeps_the_wall_clock_on_average() -> None:
    pacer = Pacer(0.001, now=0.0)
    rng = np.random.default_rng(1)
    now, steps = 0.0, 0
    while now < 1.0:
        now += float(rng.uniform(0.0, 0.003))
        steps += pacer.due(now)
    assert steps == pytest.approx(now / 0.001, abs=1)
    assert pacer.overruns == 0


def test_pacer_drops_what_it_cannot_catch_up() -> None:
    pacer = Pacer(0.001, now=0.0)
    assert pacer.due(0.0505) == MAX_CATCH_UP
    assert pacer.overruns == 50 - MAX_CATCH_UP
    assert pacer.due(0.0506) == 0
    assert pacer.due(0.0511) == 1


def test_watchdog_holds_until_fresh_commands_in_a_row_and_after_a_silence() -> None:
    dog = Watchdog(20 * MS)
    assert dog.check(0)
    for k in range(FRESH_COMMANDS_TO_RESUME):
        assert dog.check(k * MS)
        assert dog.refuses(k * MS, k * MS) == ""
        dog.accept(k * MS)
    last = (FRESH_COMMANDS_TO_RESUME - 1) * MS
    assert not dog.check(last + 20 * MS)
    assert dog.check(last + 21 * MS)
    dog.accept(last + 21 * MS)
    assert dog.check(last + 22 * MS), "one command is not enough to resume"


@pytest.mark.parametrize(
    ("stamp", "now", "why"),
    [
        (9 * MS, 10 * MS, "answered_before"),
        (10 * MS, 12 * MS, "answered_before"),
        (11 * MS, 12 * MS, ""),
        (13 * MS, 12 * MS, "stamp_of_no_state"),
        (11 * MS, 32 * MS, "stale"),
    ],
)
def test_watchdog_refuses_what_is_not_news(stamp: int, now: int, why: str) -> None:
    dog = Watchdog(20 * MS)
    dog.accept(10 * MS)
    assert dog.refuses(stamp, now) == why


def test_gate_keeps_every_torque_inside_limits_and_rate() -> None:
    rng = np.random.default_rng(7)
    limit = np.array([5.0, 3.0, np.inf])
    gate = TorqueGate(limit, torque_rate_limit=1000.0, control_dt=1e-3)
    previous = np.zeros(3)
    for _ in range(500):
        wanted = rng.normal(scale=6.0, size=3)
        torque, limit_hit, rate_hit = gate(wanted, previous)
        assert (np.abs(torque) <= limit).all()
        assert (np.abs(torque - previous) <= 1.0 + 1e-12).all()
        assert limit_hit == bool((np.abs(wanted) > limit + 1e-6).any())
        assert rate_hit == bool((np.abs(wanted - previous) > 1.0 + 1e-6).any())
        previous = torque


def test_gate_passes_what_is_inside_unchanged_and_counts_no_rounding() -> None:
    gate = TorqueGate(np.array([5.0, 5.0]), 0.0, 1e-3)
    torque = np.array([4.9, -5.0])
    np.testing.assert_array_equal(gate(torque, -torque).torque, torque)
    assert gate(torque, -torque)[1:] == (False, False)
    rounded = gate(np.array([5.0 + 1e-9, 0.0]), torque)
    assert rounded.torque[0] == 5.0
    assert not rounded.limit_hit


def test_decimator_keeps_one_message_per_grid_cell_aligned_across_topics() -> None:
    kept = [
        [stamp for stamp in range(start, 1_000 * MS, MS) if keeps(stamp)]
        for start, keeps in ((0, Decimator(10 * MS).keeps), (3 * MS, Decimator(10 * MS).keeps))
    ]
    assert kept[0] == list(range(0, 1_000 * MS, 10 * MS))
    assert kept[1][1:] == kept[0][1:]


def test_decimator_starts_anew_when_time_goes_back() -> None:
    decimator = Decimator(10 * MS)
    assert [decimator.keeps(t * MS) for t in (0, 5, 30, 0, 5)] == [True, False, True, True, False]


def test_patient_publishing_tries_until_there_is_room() -> None:
    sent: list[bytes] = []
    full = [True, True, False]

    def publish(data: bytes) -> None:
        if full.pop(0):
            raise RuntimeError("cannot publish data")
        sent.append(data)

    patient(publish, "joint_states", 5.0, lambda: False)(b"state")
    assert sent == [b"state"]


def test_patient_publishing_gives_up_with_the_topic_and_at_once_when_stopping() -> None:
    def publish(data: bytes) -> None:
        raise RuntimeError("cannot publish data")

    with pytest.raises(PartnerMissing, match="a reader of 'joint_states' took nothing"):
        patient(publish, "joint_states", 0.01, lambda: False)(b"state")
    patient(publish, "joint_states", 60.0, lambda: True)(b"state")


def test_recording_waits_for_the_first_clock() -> None:
    written: list[tuple[str, int]] = []
    timeline = RecordingTimeline(start_ns=100, restart=written.clear)
    timeline.write(200, lambda t: written.append(("before", t)))
    assert written == [("before", 200)], "on the disk, for a recorder that is killed before"
    timeline.clock(7 * MS)
    timeline.write(300, lambda t: written.append(("after", t)))
    assert written == [("before", 7 * MS), ("after", 7 * MS)]


def test_recording_without_a_clock_runs_on_wall_time() -> None:
    written: list[int] = []
    timeline = RecordingTimeline(start_ns=0, restart=written.clear)
    timeline.write(5, written.append)
    timeline.write(PATIENCE_NS + 6, written.append)
    timeline.clock(1)
    timeline.write(PATIENCE_NS + 7, written.append)
    assert written == [5, PATIENCE_NS + 6, PATIENCE_NS + 7]

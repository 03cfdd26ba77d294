"""What a replay publishes and when: order, times, start, latched topics, loops, cuts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_recording import BagRecording
from ghc_sim_bridge.recorder.playback import Entry, Pace, chosen, contents, playback

SCHEMA = "int32 sec\nuint32 nanosec\n"
FAST = BagTopic("/fast", "builtin_interfaces/msg/Time", SCHEMA)
LATCHED = BagTopic(
    "/latched",
    "builtin_interfaces/msg/Duration",
    SCHEMA,
    ({"durability": "transient_local", "depth": 1},),
)
ALL = ("/fast", "/latched")
MS = 1_000_000  # [ns]


def record(folder: Path, times: list[int]) -> Path:
    """A message of /fast at each time [ms], one of /latched with every tenth."""
    recording = BagRecording(folder)
    for topic in (FAST, LATCHED):
        recording.add_topic(topic)
    for k, time in enumerate(times):
        if k % 10 == 0:
            recording.write("/latched", time * MS, k, f"latched {k}".encode())
        recording.write("/fast", time * MS, k, f"fast {k}".encode())
    recording.close()
    return folder


def texts(entries: Iterator[Entry], topic: str) -> list[str]:
    return [entry.data.decode() for entry in entries if entry.topic == topic]


def test_every_message_in_its_order_with_the_time_since_the_first(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    times = list(map(int, 500 + np.cumsum(rng.integers(0, 7, 200))))
    path = record(tmp_path / "run", times)
    assert contents(path).messages == 220
    assert contents(path).duration == (times[-1] - times[0]) * MS
    played = [entry for entry in playback(path, ALL, 0.0) if entry.topic == "/fast"]
    assert texts(iter(played), "/fast") == [f"fast {k}" for k in range(200)]
    assert [entry.position for entry in played] == [(t - times[0]) * MS for t in times]
    assert [entry.log_time for entry in played] == [t * MS for t in times]


def test_where_time_went_back_none_passes(tmp_path: Path) -> None:
    path = record(tmp_path / "run", [0, 10, 20, 0, 10, 5])
    fast = list(playback(path, ["/fast"], 0.0))
    assert [entry.position // MS for entry in fast] == [0, 10, 20, 20, 30, 30]


def test_from_a_later_start_latched_topics_say_their_last_message_first(tmp_path: Path) -> None:
    path = record(tmp_path / "run", list(range(100)))
    entries = list(playback(path, ALL, 0.0555))
    assert entries[0].data == b"latched 50"
    assert entries[0].position == round(55.5 * MS)
    assert texts(iter(entries), "/fast") == [f"fast {k}" for k in range(56, 100)]
    assert texts(iter(entries), "/latched") == [f"latched {k}" for k in range(50, 100, 10)]
    alone = list(playback(path, ["/latched"], 0.095))
    assert [(entry.data, entry.position) for entry in alone] == [(b"latched 90", 95 * MS)]


def test_a_recording_that_was_cut_is_played_up_to_there(tmp_path: Path) -> None:
    recording = BagRecording(tmp_path / "run")
    recording.add_topic(FAST)
    for k in range(50):
        recording.write("/fast", k * MS, k, f"fast {k}".encode())
        if k == 29:
            recording.checkpoint()
    recording.abandon()
    whole = recording.path.read_bytes()
    recording.path.write_bytes(whole[:-30])
    for path in (tmp_path / "run", recording.path):
        assert texts(playback(path, ["/fast"], 0.0), "/fast") == [f"fast {k}" for k in range(30)]


def test_the_pace_is_that_of_the_clock_times_the_rate(tmp_path: Path) -> None:
    path = record(tmp_path / "run", [100 + 10 * k for k in range(20)])
    pace = Pace(partial(playback, path, ["/fast"], 0.0), rate=4.0, loop=False)
    for wall in range(7_000, 7_060, 2):
        played = [entry.position for entry in pace.due(wall * MS)]
        assert all((wall - 7_002) * 4 * MS < p <= (wall - 7_000) * 4 * MS for p in played[1:])
        assert pace.done == ((wall - 7_000) * 4 >= 190)


def test_a_loop_begins_again(tmp_path: Path) -> None:
    path = record(tmp_path / "run", list(range(5)))
    pace = Pace(partial(playback, path, ["/fast"], 0.0), rate=1.0, loop=True)
    said = [entry.data.decode() for wall in range(40) for entry in pace.due(wall * MS)]
    assert said[:15] == [f"fast {k}" for k in range(5)] * 3
    assert not pace.done


def test_topics_are_chosen_by_name(tmp_path: Path) -> None:
    known = contents(record(tmp_path / "run", [0, 1]))
    assert list(chosen(known, ())) == list(ALL)
    assert list(chosen(known, ("latched",))) == list(chosen(known, ("/latched",))) == ["/latched"]
    with pytest.raises(UnknownName, match="'/slow'; known: /fast, /latched"):
        chosen(known, ("slow",))


def test_a_recording_without_messages_is_named(tmp_path: Path) -> None:
    BagRecording(tmp_path / "run").close()
    with pytest.raises(ConfigurationError, match=r"run': it holds no message"):
        contents(tmp_path / "run")
    with pytest.raises(ConfigurationError, match=r"moon.mcap"):
        contents(tmp_path / "moon.mcap")

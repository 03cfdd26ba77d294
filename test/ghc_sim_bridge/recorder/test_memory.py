"""A recording costs no memory for what it has written, and its index is whole."""

from __future__ import annotations

import gc
import tracemalloc
from pathlib import Path

from mcap.reader import SeekingReader

from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_recording import BagRecording

TOPICS = tuple(BagTopic(f"/topic_{i}", "std_msgs/msg/String", "string data") for i in range(14))


def _begun(folder: Path) -> BagRecording:
    """An empty bag of all topics."""
    recording = BagRecording(folder)
    for topic in TOPICS:
        recording.add_topic(topic)
    return recording


def _record(recording: BagRecording, first: int, checkpoints: int) -> None:
    """As many checkpoints, each with one message of every topic at its number [ns]."""
    for time in range(first, first + checkpoints):
        for topic in TOPICS:
            recording.write(topic.name, time, time, time.to_bytes(100, "little"))
        recording.checkpoint()


def test_memory_does_not_grow_with_what_was_recorded(tmp_path: Path) -> None:
    """At two checkpoints a second, 1 kB kept of each is 7 MB per hour."""
    recording = _begun(tmp_path)
    _record(recording, 0, 50)
    tracemalloc.start()
    gc.collect()
    before, _ = tracemalloc.get_traced_memory()
    _record(recording, 50, 250)
    gc.collect()
    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    recording.close()
    assert (after - before) / 250 < 50.0, "bytes kept per checkpoint"


def test_the_index_finds_every_message(tmp_path: Path) -> None:
    recording = _begun(tmp_path)
    _record(recording, 5, 30)
    recording.close()
    with recording.path.open("rb") as stream:
        reader = SeekingReader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert len(summary.chunk_indexes) == summary.statistics.chunk_count == 30
        assert (summary.statistics.message_start_time, summary.statistics.message_end_time) == (
            5,
            34,
        )
        assert summary.statistics.channel_message_counts == dict.fromkeys(range(1, 15), 30)
        some = reader.iter_messages(topics=["/topic_3"], start_time=20, end_time=25)
        found = [int.from_bytes(message.data, "little") for _, _, message in some]
        assert found == [20, 21, 22, 23, 24]
        assert sum(1 for _ in reader.iter_messages()) == 30 * len(TOPICS)

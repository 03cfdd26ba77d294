"""A recording opens wherever it was cut, and when the disk was full."""

from __future__ import annotations

import errno
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from ghc_controller.errors import ConfigurationError
from ghc_sim_bridge.programs.repair_bag import main as repair_main
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_reading import read_messages
from ghc_sim_bridge.recorder.bag_recording import BagRecording
from ghc_sim_bridge.recorder.repair import repair_bag

TIME = BagTopic(
    "/time",
    "builtin_interfaces/msg/Time",
    "int32 sec\nuint32 nanosec\n",
    (
        {
            "history": "keep_last", "reliability": "reliable", "durability": "volatile",
            "liveliness": "automatic", "depth": 1,
            "deadline": {"sec": 9223372036, "nsec": 854775807},
            "lifespan": {"sec": 9223372036, "nsec": 854775807},
            "liveliness_lease_duration": {"sec": 9223372036, "nsec": 854775807},
            "avoid_ros_namespace_conventions": False,
        },
    ) * 2,
)  # fmt: skip
OTHER = BagTopic("/other", "builtin_interfaces/msg/Duration", "int32 sec\nuint32 nanosec\n")
STEP_NS = 10_000_000  # [ns] between two messages
PER_CHECKPOINT = 50  # [-] messages: half a second


def _cdr(k: int) -> bytes:
    """Message k: sec = k, nanosec = 7 k."""
    return b"\x00\x01\x00\x00" + k.to_bytes(4, "little") + (7 * k).to_bytes(4, "little")


def _write(recording: BagRecording, numbers: Sequence[int]) -> None:
    for k in numbers:
        recording.write("/time", k * STEP_NS, k, _cdr(k))


def _record(folder: Path, checkpoints: int) -> tuple[BagRecording, list[int]]:
    """A bag with so many checkpoints, and the size [bytes] of its data after each one."""
    recording = BagRecording(folder)
    recording.add_topic(TIME)
    recording.add_topic(OTHER)
    ends = []
    for i in range(checkpoints):
        _write(recording, range(i * PER_CHECKPOINT, (i + 1) * PER_CHECKPOINT))
        recording.checkpoint()
        ends.append(_size(recording.path) - END_SIZE)
    return recording, ends


def _size(path: Path) -> int:
    return path.stat().st_size


END_SIZE = 13 + 29 + 8  # [bytes] DataEnd, Footer, magic


def _read(folder: Path) -> list[int]:
    """Numbers of the messages, as rosbags reads and decodes them; the times must fit them."""
    numbers = []
    with AnyReader([folder]) as reader:
        for connection, time_ns, data in reader.messages():
            assert connection.topic == "/time"
            message: Any = reader.deserialize(data, connection.msgtype)
            assert (time_ns, message.nanosec) == (message.sec * STEP_NS, 7 * message.sec)
            numbers.append(message.sec)
    return numbers


def test_the_bag_opens_after_every_checkpoint_and_when_closed(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    recording = BagRecording(folder)
    with Reader(folder) as reader:
        assert reader.message_count == 0
    recording.add_topic(TIME)
    for i in range(4):
        _write(recording, range(i * PER_CHECKPOINT, (i + 1) * PER_CHECKPOINT))
        recording.checkpoint()
        assert _read(folder) == list(range((i + 1) * PER_CHECKPOINT))
    _write(recording, [200])
    assert _read(folder)[-1] == 199  # not on the disk yet
    recording.close()
    assert _read(folder) == list(range(201))
    with Reader(folder) as reader:
        assert (reader.message_count, reader.start_time) == (201, 0)
        assert reader.duration == 200 * STEP_NS + 1
        ext: Any = reader.connections[0].ext
        assert len(ext.offered_qos_profiles) == 2
    text = (folder / "metadata.yaml").read_text()
    assert "&" not in text and "*" not in text, "no anchors: readers in C++ are simple"
    assert {path.name for path in folder.iterdir()} == {"run_0.mcap", "metadata.yaml"}


def test_a_file_cut_at_any_byte_opens_up_to_its_last_checkpoint(tmp_path: Path) -> None:
    recording, ends = _record(tmp_path / "whole", 6)
    recording.close()
    data = recording.path.read_bytes()
    rng = np.random.default_rng(3)
    near = [end + d for end in ends for d in (-1, 0, 1) if end + d <= len(data)]
    cuts = {0, 1, 7, 8, 9, 40, len(data) - 1, len(data), *near}
    cuts |= set(rng.integers(0, len(data), 60).tolist())
    folder = tmp_path / "cut"
    folder.mkdir()
    metadata = (tmp_path / "whole" / "metadata.yaml").read_bytes()
    for cut in sorted(cuts):
        (folder / "whole_0.mcap").write_bytes(data[:cut])
        (folder / "metadata.yaml").write_bytes(metadata)
        # Message indexes stand behind a chunk, so it is complete a little before its checkpoint.
        least = PER_CHECKPOINT * sum(end <= cut for end in ends)
        read = [message.sec for _, _, message in read_messages(folder)]
        assert read == list(range(len(read))), cut
        assert least <= len(read) <= least + PER_CHECKPOINT, cut
        assert repair_bag(folder).messages == len(read), cut
        assert _read(folder) == read, cut
        assert {p.name for p in folder.iterdir()} == {"whole_0.mcap", "metadata.yaml"}


def test_a_write_that_was_cut_short_leaves_what_was_before(tmp_path: Path) -> None:
    """A kill inside of the write itself: the old end of the file is overwritten in part."""
    recording, (first, _) = _record(tmp_path / "run", 2)
    data = recording.path.read_bytes()
    before, _ = _record(tmp_path / "before", 1)
    old = before.path.read_bytes()
    for torn in np.random.default_rng(5).integers(first, len(data), 25).tolist():
        recording.path.write_bytes(data[:torn] + old[torn:])
        read = [message.sec for _, _, message in read_messages(tmp_path / "run")]
        assert read[:PER_CHECKPOINT] == list(range(PER_CHECKPOINT))
        assert len(read) in (PER_CHECKPOINT, 2 * PER_CHECKPOINT)
        assert repair_bag(tmp_path / "run").messages == len(read)
        assert _read(tmp_path / "run") == read


def test_a_full_disk_keeps_the_last_checkpoint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pwrite = os.pwrite
    for space in range(0, 400, 23):
        folder = tmp_path / str(space)
        recording, (end, *_) = _record(folder, 1)
        limit = end + END_SIZE + space

        def full(fd: int, data: memoryview, offset: int, limit: int = limit) -> int:
            if offset >= limit:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return pwrite(fd, data[: limit - offset], offset)

        rng = np.random.default_rng(space)
        for k in range(PER_CHECKPOINT, 5 * PER_CHECKPOINT):  # noise, which does not compress
            recording.write("/other", k * STEP_NS, k, rng.bytes(12))
        monkeypatch.setattr(os, "pwrite", full)
        with pytest.raises(OSError, match="No space left"):
            recording.checkpoint()
        monkeypatch.undo()
        recording.abandon()
        assert _size(recording.path) == end + END_SIZE
        assert _read(folder) == list(range(PER_CHECKPOINT))
        with Reader(folder) as reader:
            assert reader.message_count == PER_CHECKPOINT


def test_metadata_that_finds_no_space_stays_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording, _ = _record(tmp_path / "run", 1)

    def full(*_: object, **__: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(OSError, match="No space left"):
        recording.checkpoint()
    monkeypatch.undo()
    metadata = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())
    assert metadata["rosbag2_bagfile_information"]["message_count"] == PER_CHECKPOINT
    assert _read(tmp_path / "run") == list(range(PER_CHECKPOINT))


def test_repair_by_its_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording, ends = _record(tmp_path / "run", 3)
    recording.abandon()
    os.truncate(recording.path, ends[1] + 5)
    assert repair_main([str(tmp_path / "run")]) == 0
    assert "100 messages, t = 0.000 s to 0.990 s" in capsys.readouterr().out
    assert _read(tmp_path / "run") == list(range(100))
    assert repair_main([str(tmp_path)]) == 2
    assert "no .mcap file" in capsys.readouterr().err


def test_what_is_no_recording_is_one_clear_error(tmp_path: Path) -> None:
    other = tmp_path / "other.mcap"
    other.write_text("neither MCAP nor short")
    for path in (tmp_path / "nowhere", tmp_path / "nowhere.mcap", other):
        with pytest.raises(ConfigurationError, match=path.stem):
            list(read_messages(path))
    with pytest.raises(ConfigurationError, match="with one"):
        repair_bag(other)

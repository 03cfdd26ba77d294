"""A recording of topics as a rosbag2 folder: an MCAP file and its metadata.yaml."""

from __future__ import annotations

from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.records import DataEnd, Footer
from mcap.writer import MCAP0_MAGIC

from ghc_sim_bridge.recorder.bag_metadata import (
    METADATA,
    SERIALIZATION,
    BagExtent,
    BagTopic,
    metadata_text,
    qos_text,
)
from ghc_sim_bridge.recorder.chunked_writer import ChunkedWriter
from ghc_sim_bridge.recorder.cut_safe_file import CutSafeFile

PROFILE = "ros2"
LIBRARY = "ghc_sim_bridge recorder"
SCHEMA_ENCODING = "ros2msg"
QOS_KEY = "offered_qos_profiles"  # of a channel's metadata, as rosbag2 names them
HASH_KEY = "topic_type_hash"


class BagRecording:
    """Serialized messages by topic.

    `checkpoint` writes all messages so far to the disk; from its creation on, also between two
    checkpoints, the folder is a readable bag. `close` adds the index of the MCAP file.
    """

    def __init__(self, folder: Path, file: str = "") -> None:
        """Create an empty bag; one that is there already is replaced.

        `file` is the name of the MCAP file; without it rosbag2's own, <folder>_0.mcap.

        Raises:
            OSError: it cannot be written there.
        """
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / (file or f"{folder.name}_0.mcap")
        self._metadata = folder / METADATA
        self._topics: dict[str, BagTopic] = {}
        self._begin()

    def restart(self) -> None:
        """Discard all messages and begin the file again, with the same topics.

        Raises:
            OSError: it cannot be written any more.
        """
        self._close_files()
        self._begin()

    def _begin(self) -> None:
        self._file = CutSafeFile(self.path)
        self._writer = ChunkedWriter(self._file, self.path.parent, PROFILE, LIBRARY)
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._counts: dict[str, int] = {}
        self._start_ns: int | None = None
        self._end_ns = 0
        topics, self._topics = self._topics, {}
        for topic in topics.values():
            self.add_topic(topic)
        self.checkpoint()

    def add_topic(self, topic: BagTopic) -> None:
        """Declare a topic, before its messages."""
        if topic.type_name not in self._schemas:
            self._schemas[topic.type_name] = self._writer.register_schema(
                topic.type_name, SCHEMA_ENCODING, topic.schema.encode()
            )
        self._channels[topic.name] = self._writer.register_channel(
            topic.name,
            SERIALIZATION,
            self._schemas[topic.type_name],
            {QOS_KEY: qos_text(topic.offered_qos), HASH_KEY: topic.type_hash},
        )
        self._topics[topic.name] = topic
        self._counts[topic.name] = 0

    def write(self, topic: str, log_time_ns: int, publish_time_ns: int, data: bytes) -> None:
        """Add a message; log time on the timeline of the file, publish time of the wall [ns]."""
        if self._start_ns is None:
            self._start_ns = self._end_ns = log_time_ns
        self._start_ns = min(self._start_ns, log_time_ns)
        self._end_ns = max(self._end_ns, log_time_ns)
        count = self._counts[topic] + 1
        self._counts[topic] = count
        self._writer.add_message(
            self._channels[topic], log_time_ns, data, publish_time_ns, sequence=count
        )

    @property
    def extent(self) -> BagExtent:
        """How much was written so far."""
        return BagExtent(dict(self._counts), self._start_ns or 0, self._end_ns)

    @property
    def pending(self) -> int:
        """Bytes, compressed, that wait for a checkpoint; those of an open chunk come on top."""
        return self._file.pending

    def checkpoint(self) -> None:
        """Write all messages so far to the disk.

        Raises:
            OSError: no space is left, for example; the bag is that of the last checkpoint.
        """
        self._writer.flush()
        self._file.commit(_END)
        self._write_metadata()

    def close(self) -> None:
        """Write the rest, the index and the metadata.

        Raises:
            OSError: as `checkpoint`.
        """
        try:
            self._writer.finish()
            self._file.commit(b"")
            self._write_metadata()
        finally:
            self._close_files()

    def abandon(self) -> None:
        """Close the file as the last checkpoint left it."""
        self._close_files()

    def _close_files(self) -> None:
        self._writer.close()
        self._file.close()

    def _write_metadata(self) -> None:
        """Through a temporary file, so that metadata.yaml is complete at any time."""
        text = metadata_text(self.path.name, list(self._topics.values()), self.extent)
        draft = self._metadata.with_suffix(".yaml.tmp")
        try:
            draft.write_text(text, encoding="utf-8")
            draft.replace(self._metadata)
        except OSError:
            draft.unlink(missing_ok=True)
            raise


def _end_of_file() -> bytes:
    """End of an MCAP file that has no index: readers then scan it from the start."""
    builder = RecordBuilder()
    DataEnd(data_section_crc=0).write(builder)
    Footer(summary_start=0, summary_offset_start=0, summary_crc=0).write(builder)
    return bytes(builder.end()) + MCAP0_MAGIC


_END = _end_of_file()

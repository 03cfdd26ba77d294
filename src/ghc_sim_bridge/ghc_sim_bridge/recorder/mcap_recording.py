"""A recording of ROS topics as one MCAP file that needs no ROS to be read."""

from __future__ import annotations

from pathlib import Path

from mcap.writer import CompressionType, Writer

PROFILE = "ros2"
SCHEMA_ENCODING = "ros2msg"
MESSAGE_ENCODING = "cdr"


class McapRecording:
    """Serialized messages by topic; the file is complete after `close`."""

    def __init__(self, path: Path) -> None:
        """Create the file and the folder that it is in.

        Raises:
            OSError: it cannot be written there.
        """
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("wb")
        self._writer = Writer(self._file, compression=CompressionType.ZSTD)
        self._writer.start(profile=PROFILE, library="ghc_sim_bridge recorder")
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._counts: dict[str, int] = {}

    def add_topic(self, topic: str, type_name: str, schema: str, qos: str) -> None:
        """Announce `topic` with its type, the type's text and, for a replay, its QoS."""
        if type_name not in self._schemas:
            self._schemas[type_name] = self._writer.register_schema(
                type_name, SCHEMA_ENCODING, schema.encode()
            )
        self._channels[topic] = self._writer.register_channel(
            topic, MESSAGE_ENCODING, self._schemas[type_name], {"qos": qos}
        )
        self._counts[topic] = 0

    def write(self, topic: str, log_time_ns: int, publish_time_ns: int, data: bytes) -> None:
        """Add a message; log time on the timeline of the file, publish time of the wall [ns]."""
        count = self._counts[topic] + 1
        self._counts[topic] = count
        self._writer.add_message(
            self._channels[topic], log_time_ns, data, publish_time_ns, sequence=count
        )

    @property
    def counts(self) -> dict[str, int]:
        """Messages written so far by topic."""
        return dict(self._counts)

    def close(self) -> None:
        """Write index and footer."""
        self._writer.finish()
        self._file.close()

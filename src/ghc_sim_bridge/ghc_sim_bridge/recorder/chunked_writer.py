"""Writer of an MCAP file whose memory does not depend on how much it has written.

The writer of the package `mcap` keeps one index entry per chunk as Python objects until the file
is finished: 2 to 4 kB each with a dozen topics, and a recording that reaches the disk twice a
second has 7200 chunks an hour. Here the entries are kept in an unnamed file next to the recording,
already in the bytes of the summary.

Format: https://mcap.dev/spec
"""

from __future__ import annotations

import struct
import tempfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import MCAP0_MAGIC

CHUNK_SIZE = 2**20  # [bytes] of messages, uncompressed, that end a chunk
COMPRESSION = "zstd"


class Output(Protocol):
    """Output stream of the writer."""

    def write(self, data: bytes) -> int:
        """Append."""
        ...

    def tell(self) -> int:
        """Position [bytes] of the next byte."""
        ...


class ChunkedWriter:
    """Schemas, channels and messages into compressed chunks; the index of them at the end."""

    def __init__(self, output: Output, folder: Path, profile: str, library: str) -> None:
        """Begin a file; OSError when `folder` takes no file for the index."""
        self._output = output
        # Without a buffer: what a full disk did not take is not written again by `close`.
        self._spool = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
        self._entries = bytearray()  # of the index, since the last flush
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._statistics = Statistics(
            attachment_count=0, channel_count=0, channel_message_counts={}, chunk_count=0,
            message_count=0, message_end_time=0, message_start_time=0, metadata_count=0,
            schema_count=0,
        )  # fmt: skip
        self._begin_chunk()
        output.write(MCAP0_MAGIC + _bytes_of(Header(profile, library)))

    def register_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Declare a message type; returns its number."""
        schema = Schema(id=len(self._schemas) + 1, data=data, encoding=encoding, name=name)
        self._schemas.append(schema)
        schema.write(self._chunk)
        return schema.id

    def register_channel(
        self, topic: str, encoding: str, schema_id: int, metadata: Mapping[str, str]
    ) -> int:
        """Declare a topic; returns its number."""
        number = len(self._channels) + 1
        channel = Channel(
            id=number, topic=topic, message_encoding=encoding, metadata=dict(metadata),
            schema_id=schema_id,
        )  # fmt: skip
        self._channels.append(channel)
        channel.write(self._chunk)
        return number

    def add_message(
        self, channel_id: int, log_time: int, data: bytes, publish_time: int, sequence: int
    ) -> None:
        """Add a message; times in ns."""
        index = self._indices.setdefault(channel_id, MessageIndex(channel_id, []))
        index.records.append((log_time, self._chunk.count))
        Message(channel_id, log_time, data, publish_time, sequence).write(self._chunk)
        counts = self._statistics.channel_message_counts
        counts[channel_id] = counts.get(channel_id, 0) + 1
        if self._chunk.count > CHUNK_SIZE:
            self._end_chunk()

    def flush(self) -> None:
        """End the chunk in progress, and write the entries of the index to the disk.

        Raises:
            OSError: no space is left.
        """
        self._end_chunk()
        while self._entries:
            del self._entries[: self._spool.write(self._entries)]

    def finish(self) -> None:
        """Write what is left, and the summary: schemas, channels, statistics, index.

        Raises:
            OSError: as `flush`.
        """
        self.flush()
        self._output.write(_bytes_of(DataEnd(0)))
        start = at = self._output.tell()
        self._spool.seek(0)
        s = self._statistics
        s.schema_count, s.channel_count = len(self._schemas), len(self._channels)
        s.message_count = sum(s.channel_message_counts.values())
        groups = (
            (Opcode.SCHEMA, _bytes_of(*self._schemas)),
            (Opcode.CHANNEL, _bytes_of(*self._channels)),
            (Opcode.STATISTICS, _bytes_of(s)),
            (Opcode.CHUNK_INDEX, self._spool.read()),
        )
        offsets, check = b"", 0
        for opcode, data in groups:
            offsets += _bytes_of(SummaryOffset(opcode, at, len(data)))
            self._output.write(data)
            check = zlib.crc32(data, check)
            at += len(data)
        self._output.write(offsets)
        # The check sum covers the footer up to itself.
        head = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, at)
        check = zlib.crc32(head, zlib.crc32(offsets, check))
        self._output.write(_bytes_of(Footer(start, at, check)) + MCAP0_MAGIC)

    def close(self) -> None:
        """Close the file of the index."""
        self._spool.close()

    def _begin_chunk(self) -> None:
        self._chunk = RecordBuilder()
        self._indices: dict[int, MessageIndex] = {}

    def _end_chunk(self) -> None:
        """Write the chunk in progress, if it has a message, and the index of its messages."""
        if not self._indices:
            return
        times = [time for index in self._indices.values() for time, _ in index.records]
        first, last, statistics = min(times), max(times), self._statistics
        if statistics.chunk_count == 0:
            statistics.message_start_time = first
        statistics.chunk_count += 1
        statistics.message_start_time = min(first, statistics.message_start_time)
        statistics.message_end_time = max(last, statistics.message_end_time)
        plain = self._chunk.end()
        data = zstandard.compress(plain)
        chunk = _bytes_of(
            Chunk(
                compression=COMPRESSION, data=data, message_end_time=last,
                message_start_time=first, uncompressed_crc=zlib.crc32(plain),
                uncompressed_size=len(plain),
            )
        )  # fmt: skip
        start = self._output.tell()
        self._output.write(chunk)
        offsets, builder = {}, RecordBuilder()
        for number, index in self._indices.items():
            offsets[number] = start + len(chunk) + builder.count
            index.write(builder)
        indices = builder.end()
        self._output.write(indices)
        entry = ChunkIndex(
            chunk_length=len(chunk),
            chunk_start_offset=start,
            compression=COMPRESSION,
            compressed_size=len(data),
            message_end_time=last,
            message_index_length=len(indices),
            message_index_offsets=offsets,
            message_start_time=first,
            uncompressed_size=len(plain),
        )
        self._entries += _bytes_of(entry)
        self._begin_chunk()


def _bytes_of(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())

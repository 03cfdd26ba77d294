"""Records of an MCAP file or a rosbag2 folder, up to where it is truncated."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import yaml
from mcap.exceptions import InvalidMagic, McapError
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from zstandard import ZstdError

from ghc_controller.errors import ConfigurationError
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.bag_recording import HASH_KEY, QOS_KEY

_MAGIC_SIZE = 8  # [bytes]
# Exceptions caused by truncated or overwritten records: failed checksums are ValueErrors, and a
# random length may exceed the memory.
_CUT = (
    McapError, EOFError, ValueError, KeyError, IndexError, struct.error, ZstdError,
    MemoryError, OverflowError,
)  # fmt: skip


def storage_files(path: Path) -> list[Path]:
    """The MCAP files of a bag folder, in their order; of a file, itself.

    Raises:
        ConfigurationError: there is none.
    """
    if not path.is_dir():
        return [path]
    files = sorted(path.glob("*.mcap"))
    if not files:
        raise ConfigurationError(f"recording '{path}': no .mcap file in this folder")
    return files


def intact_records(file: Path) -> Iterator[Any]:
    """The records of an MCAP file in their order, those of the last complete chunk included.

    Raises:
        ConfigurationError: it cannot be read, or is no MCAP file.
    """
    try:
        with file.open("rb") as stream:
            try:
                yield from StreamReader(stream, validate_crcs=True).records
            except InvalidMagic as error:
                if stream.tell() <= _MAGIC_SIZE:
                    raise ConfigurationError(f"recording '{file}': no MCAP file") from error
            except _CUT:
                return
    except OSError as error:
        raise ConfigurationError(f"recording '{file}': {error}") from error


def raw_messages(path: Path) -> Iterator[tuple[BagTopic, Message | None]]:
    """Topic and message, as bytes with its times [ns], of a bag folder or an MCAP file.

    Where the file declares a topic, it is yielded without a message. Raises as `read_messages`.
    """
    for file in storage_files(path):
        schemas: dict[int, Schema] = {}
        topics: dict[int, BagTopic] = {}
        for record in intact_records(file):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                if record.id not in topics:
                    topics[record.id] = topic = _topic(record, schemas[record.schema_id])
                    yield topic, None
            elif isinstance(record, Message):
                yield topics[record.channel_id], record


def _topic(channel: Channel, schema: Schema) -> BagTopic:
    offered = yaml.safe_load(channel.metadata.get(QOS_KEY, "")) or ()
    return BagTopic(
        channel.topic,
        schema.name,
        schema.data.decode(),
        tuple(offered),
        channel.metadata.get(HASH_KEY, ""),
    )


def read_messages(path: Path, schema_name: str = "") -> Iterator[tuple[str, Message, Any]]:
    """(topic, message with its times [ns], decoded message) of a bag folder or an MCAP file.

    Only of the type `schema_name` if that is given. Raises ConfigurationError as
    `storage_files` and `intact_records`.
    """
    for file in storage_files(path):
        schemas: dict[int, Schema] = {}
        channels: dict[int, Channel] = {}
        decoders: dict[int, Callable[[bytes], Any]] = {}
        factory = DecoderFactory()
        for record in intact_records(file):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                schema = schemas[record.schema_id]
                channels[record.id] = record
                if record.id not in decoders and schema_name in ("", schema.name):
                    decoders[record.id] = factory.decoder_for(record.message_encoding, schema)
            elif isinstance(record, Message) and record.channel_id in decoders:
                decoded = decoders[record.channel_id](record.data)
                yield channels[record.channel_id].topic, record, decoded

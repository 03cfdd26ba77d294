"""Repair of a bag whose process was killed or whose disk was full: index and metadata anew."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import yaml
from mcap.records import Channel, Message, Schema

from ghc_controller.errors import ConfigurationError
from ghc_sim_bridge.recorder.bag_metadata import METADATA, BagExtent, BagTopic
from ghc_sim_bridge.recorder.bag_reading import intact_records, storage_files
from ghc_sim_bridge.recorder.bag_recording import HASH_KEY, QOS_KEY, BagRecording

_BUFFER = 8 * 2**20  # [bytes] held in memory at most, about


def repair_bag(folder: Path) -> BagExtent:
    """Rewrite a bag up to where it was cut, with an index; how much it holds.

    The old file is replaced at the end, so that nothing is lost if this is interrupted.

    Raises:
        ConfigurationError: it is no folder of one MCAP file.
        OSError: the new files cannot be written.
    """
    files = storage_files(folder)
    if not folder.is_dir() or len(files) != 1:
        raise ConfigurationError(f"recording '{folder}': a folder with one .mcap file is expected")
    draft = folder / ".repair"
    try:
        recording = BagRecording(draft, files[0].name)
        for topic, message in _messages(files[0], recording):
            recording.write(topic, message.log_time, message.publish_time, message.data)
            if recording.pending > _BUFFER:
                recording.checkpoint()
        recording.close()
        recording.path.replace(files[0])
        (draft / METADATA).replace(folder / METADATA)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return recording.extent


def _messages(file: Path, recording: BagRecording) -> Iterator[tuple[str, Message]]:
    """Topic and message of what is intact; topics are announced to `recording` on the way."""
    schemas: dict[int, Schema] = {}
    topics: dict[int, BagTopic] = {}
    for record in intact_records(file):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            if record.id not in topics:
                topics[record.id] = topic = _topic(record, schemas[record.schema_id])
                recording.add_topic(topic)
        elif isinstance(record, Message):
            yield topics[record.channel_id].name, record


def _topic(channel: Channel, schema: Schema) -> BagTopic:
    offered = yaml.safe_load(channel.metadata.get(QOS_KEY, "")) or ()
    return BagTopic(
        channel.topic,
        schema.name,
        schema.data.decode(),
        tuple(offered),
        channel.metadata.get(HASH_KEY, ""),
    )

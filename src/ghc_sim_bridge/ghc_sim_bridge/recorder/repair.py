"""Repair of a bag whose process was killed or whose disk was full: rewrites index and metadata."""

from __future__ import annotations

import shutil
from pathlib import Path

from ghc_controller.errors import ConfigurationError
from ghc_sim_bridge.recorder.bag_metadata import METADATA, BagExtent
from ghc_sim_bridge.recorder.bag_reading import raw_messages, storage_files
from ghc_sim_bridge.recorder.bag_recording import BagRecording

_BUFFER = 8 * 2**20  # [bytes] approximate limit of the memory used


def repair_bag(folder: Path) -> BagExtent:
    """Rewrite a bag up to where it is truncated, with an index; returns its extent.

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
        for topic, message in raw_messages(files[0]):
            if message is None:
                recording.add_topic(topic)
                continue
            recording.write(topic.name, message.log_time, message.publish_time, message.data)
            if recording.pending > _BUFFER:
                recording.checkpoint()
        recording.close()
        recording.path.replace(files[0])
        (draft / METADATA).replace(folder / METADATA)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return recording.extent

"""metadata.yaml of a rosbag2 folder: what `ros2 bag` and rosbags read first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

METADATA = "metadata.yaml"
STORAGE = "mcap"
SERIALIZATION = "cdr"
_VERSION = 9  # of the layout, as Jazzy writes it
_DISTRO = "jazzy"
# libyaml's dumper is an order of magnitude faster; not every build of PyYAML has it.
_DUMPER: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)

Qos = Mapping[str, Any]  # one offered profile by rosbag2's names


@dataclass(frozen=True, slots=True)
class BagTopic:
    """A topic of a bag."""

    name: str
    type_name: str  # such as "sensor_msgs/msg/JointState"
    schema: str  # text of the message and of those that it contains
    offered_qos: tuple[Qos, ...] = ()  # of its publishers, for a replay
    type_hash: str = ""  # RIHS01 of the type; empty = unknown


@dataclass(frozen=True, slots=True)
class BagExtent:
    """Number of messages and times of a bag."""

    counts: Mapping[str, int]  # messages by topic
    start_ns: int = 0  # [ns] log time of the first message
    end_ns: int = 0  # [ns] and of the last one

    @property
    def messages(self) -> int:
        """Messages of all topics."""
        return sum(self.counts.values())


def metadata_text(file: str, topics: Sequence[BagTopic], extent: BagExtent) -> str:
    """Text of metadata.yaml for a bag with the one storage file `file`."""
    start = {"nanoseconds_since_epoch": extent.start_ns}
    duration = {"nanoseconds": max(extent.end_ns - extent.start_ns, 0)}
    information = {
        "version": _VERSION,
        "storage_identifier": STORAGE,
        "duration": dict(duration),
        "starting_time": dict(start),
        "message_count": extent.messages,
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": topic.name,
                    "type": topic.type_name,
                    "serialization_format": SERIALIZATION,
                    "offered_qos_profiles": [_plain(qos) for qos in topic.offered_qos],
                    "type_description_hash": topic.type_hash,
                },
                "message_count": extent.counts.get(topic.name, 0),
            }
            for topic in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file],
        "files": [
            {
                "path": file,
                "starting_time": start,
                "duration": duration,
                "message_count": extent.messages,
            }
        ],
        "custom_data": None,
        "ros_distro": _DISTRO,
    }
    return _dump({"rosbag2_bagfile_information": information})


def qos_text(offered: Sequence[Qos]) -> str:
    """Profiles as text, the form that a channel of the MCAP file holds."""
    return _dump([_plain(qos) for qos in offered]) if offered else ""


def _plain(qos: Qos) -> dict[str, Any]:
    """A separate copy: equal objects would become anchors and aliases in the text."""
    return {k: dict(v) if isinstance(v, Mapping) else v for k, v in qos.items()}


def _dump(data: object) -> str:
    return str(yaml.dump(data, Dumper=_DUMPER, sort_keys=False, default_flow_style=False))

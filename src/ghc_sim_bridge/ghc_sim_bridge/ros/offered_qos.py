"""What the publishers of a topic offer, in the words of rosbag2's metadata."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo

from ghc_controller.types import NANOSECONDS

_NAMED = ("history", "reliability", "durability", "liveliness")
_TIMES = ("deadline", "lifespan", "liveliness_lease_duration")


def offered_qos(offers: Sequence[TopicEndpointInfo]) -> tuple[dict[str, Any], ...]:
    """Quality of service of each publisher."""
    return tuple(_profile(offer.qos_profile) for offer in offers)


def type_hash(offers: Sequence[TopicEndpointInfo]) -> str:
    """RIHS01 hash of a topic's type; empty if no publisher says it."""
    hashes = (str(offer.topic_type_hash) for offer in offers)
    return next((text for text in hashes if text.startswith("RIHS01_")), "")


def _profile(qos: QoSProfile) -> dict[str, Any]:
    times = {name: getattr(qos, name).nanoseconds for name in _TIMES}
    return {
        **{name: getattr(qos, name).name.lower() for name in _NAMED},
        "depth": qos.depth,
        **{
            name: {"sec": value // NANOSECONDS, "nsec": value % NANOSECONDS}
            for name, value in times.items()
        },
        "avoid_ros_namespace_conventions": qos.avoid_ros_namespace_conventions,
    }

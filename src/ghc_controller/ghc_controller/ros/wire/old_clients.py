"""Detects nodes of another version: same topics, different message definitions."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

_UNKNOWN = "_NODE_NAME_UNKNOWN_"  # name in rcl of an endpoint whose node is not discovered yet


class OldClients:
    """Finds nodes with different message definitions on this node's topics.

    The middleware matches them by type name, or silently does not match them.
    """

    def __init__(self, node: Node) -> None:
        """Start with the first topic."""
        self._node = node
        self._turn = 0
        self._told: set[tuple[str, str]] = set()  # topic and node

    def look(self) -> str:
        """Check one topic per call, in turn; returns a warning, or "" for nothing new.

        A check of one topic takes a fraction of a millisecond; all of them take several.
        """
        node = self._node
        topics = sorted({entry.topic_name for entry in (*node.publishers, *node.subscriptions)})
        topic = topics[self._turn % len(topics)]
        self._turn += 1
        found = [
            *node.get_publishers_info_by_topic(topic),
            *node.get_subscriptions_info_by_topic(topic),
        ]
        own = [entry for entry in found if _name(entry) == node.get_fully_qualified_name()]
        complaints = []
        for entry in found:
            if not own or _UNKNOWN in entry.node_name or _same(entry, own[0]):
                continue
            if (topic, _name(entry)) in self._told:
                continue
            self._told.add((topic, _name(entry)))
            complaints.append(
                f"{topic}: node '{_name(entry)}' has another {entry.topic_type} than the "
                f"{own[0].topic_type} of this version expected: docs/migration.md"
            )
        return "; ".join(complaints)


def _name(entry: TopicEndpointInfo) -> str:
    return f"{entry.node_namespace.rstrip('/')}/{entry.node_name}"


def _same(entry: TopicEndpointInfo, own: TopicEndpointInfo) -> bool:
    """Whether the type is the same, and its definition if both state it."""
    hashes = [str(e.topic_type_hash) for e in (entry, own)]
    known = all(text.startswith("RIHS01_") for text in hashes)
    return entry.topic_type == own.topic_type and (not known or hashes[0] == hashes[1])

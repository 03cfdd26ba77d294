"""Detects nodes of another version: same topics, different message definitions."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

Ask = Callable[[str], list[TopicEndpointInfo]]
_UNKNOWN = "_NODE_NAME_UNKNOWN_"  # name in rcl of an endpoint whose node is not discovered yet


class OldClients:
    """Finds nodes with different message definitions on this node's topics.

    The middleware matches them by type name, or silently does not match them.
    """

    def __init__(self, node: Node) -> None:
        """Start with the first topic."""
        self._node = node
        self._left: list[tuple[str, Ask]] = []  # of this round: topic, and which of its ends
        self._own: dict[str, TopicEndpointInfo] = {}  # an end of this node, by topic
        self._told: set[tuple[str, str]] = set()  # topic and node

    def look(self) -> str:
        """Check one end of one topic per call, in turn; a warning, or "" for nothing new.

        That takes a tenth of a millisecond, which a control period of 1 ms has left; a whole
        topic takes several times as long.
        """
        node = self._node
        if not self._left:
            ends = (*node.publishers, *node.subscriptions)
            sides = (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
            topics = sorted({entry.topic_name for entry in ends}, reverse=True)
            self._left = [(topic, ask) for topic in topics for ask in sides]
        topic, ask = self._left.pop()
        found = ask(topic)
        mine = node.get_fully_qualified_name()
        own = next((entry for entry in found if _name(entry) == mine), self._own.get(topic))
        if own is not None:
            self._own[topic] = own
        complaints = []
        for entry in found:
            if own is None or _UNKNOWN in entry.node_name or _same(entry, own):
                continue
            if (topic, _name(entry)) in self._told:
                continue
            self._told.add((topic, _name(entry)))
            complaints.append(
                f"{topic}: node '{_name(entry)}' has another {entry.topic_type} than the "
                f"{own.topic_type} of this version expected: docs/migration.md"
            )
        return "; ".join(complaints)


def _name(entry: TopicEndpointInfo) -> str:
    return f"{entry.node_namespace.rstrip('/')}/{entry.node_name}"


def _same(entry: TopicEndpointInfo, own: TopicEndpointInfo) -> bool:
    """Whether the type is the same, and its definition if both state it."""
    hashes = [str(e.topic_type_hash) for e in (entry, own)]
    known = all(text.startswith("RIHS01_") for text in hashes)
    return entry.topic_type == own.topic_type and (not known or hashes[0] == hashes[1])

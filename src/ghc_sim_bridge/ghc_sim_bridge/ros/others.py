"""Detection of other bridges on the network, of the same or another robot."""

from __future__ import annotations

import time
from collections.abc import Callable

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.task import Future
from sensor_msgs.msg import JointState

from ghc_controller.errors import ConfigurationError
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.run import guarded
from ghc_controller.ros.wire.cdr import STAMP_END, read_stamp
from ghc_controller.ros.wire.timeline import MOST_AHEAD_NS

DISCOVERY = 0.25  # [s] wall; a running bridge on this host is discovered by then
NAMING = 5.0  # [s] wall; discovery knows a publisher before it knows the name of its node
LISTENING = 1.0  # [s] wall; one that runs publishes at least every 50 ms, also while paused
YOUTH = 5  # [s] wall
AHEAD_NS = 200_000_000  # [ns] a state of an older bridge is ahead, at least
IN_A_ROW = 20  # [-] such states that suffice
STATES, CLOCK = "joint_states", "/clock"
_UNKNOWN = "_NODE_NAME_UNKNOWN_"  # what rcl says of an endpoint before its node is discovered
_NAMELESS = "a node whose name is not known"


def publishers_of(node: Node, topic: str) -> list[str]:
    """Full names of the nodes that publish a topic, one per publisher, sorted.

    Discovery may lag behind with a name, see `_others`.
    """
    entries = node.get_publishers_info_by_topic(node.resolve_topic_name(topic))
    names = (f"{entry.node_namespace.rstrip('/')}/{entry.node_name}" for entry in entries)
    return sorted(_NAMELESS if _UNKNOWN in name else name for name in names)


def refuse_second_bridge(node: Node, since: float) -> None:
    """Wait for discovery, and raise an error if another bridge already publishes states.

    A discovered publisher that sends nothing does not count: it was killed, and the middleware has
    not detected this yet.

    Args:
        node: publishes no states yet.
        since: [s] of time.monotonic(), when the node was created: discovery continues meanwhile.

    Raises:
        ConfigurationError: joint states are already published; names the publisher.
    """
    deadline = since + DISCOVERY
    while not node.count_publishers(STATES):
        if time.monotonic() > deadline:
            return
        time.sleep(0.01)
    if first_message(node, JointState, STATES, CONTROL_SUBSCRIBER_QOS, LISTENING) is not None:
        raise ConfigurationError(_second(node))


def first_message(
    node: Node, kind: type, topic: str, qos: QoSProfile, seconds: float
) -> bytes | None:
    """The first message of a topic within `seconds` [s] of wall time, before `node` is spun."""
    heard: list[bytes] = []
    executor = SingleThreadedExecutor(context=node.context)
    listener = Node(
        f"{node.get_name()}_check", context=node.context, namespace=node.get_namespace()
    )
    listener.create_subscription(kind, node.resolve_topic_name(topic), heard.append, qos, raw=True)
    executor.add_node(listener)
    deadline = time.monotonic() + seconds
    while not heard and time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    listener.destroy_node()
    return heard[0] if heard else None


def _second(node: Node) -> str:
    return (
        f"{node.resolve_topic_name(STATES)} is published already by "
        f"{', '.join(_others(node, STATES))}: one bridge or driver per robot is expected; "
        "a second robot needs a namespace or domain of its own"
    )


def _others(node: Node, topic: str) -> list[str]:
    """Other publishers of a topic; waits for names that are not discovered yet."""
    deadline = time.monotonic() + NAMING
    while _NAMELESS in publishers_of(node, topic) and time.monotonic() < deadline:
        time.sleep(0.02)
    return other_publishers(node, topic)


def other_publishers(node: Node, topic: str) -> list[str]:
    """Full names of the other nodes that publish a topic."""
    names = publishers_of(node, topic)
    own, full_topic = node.get_fully_qualified_name(), node.resolve_topic_name(topic)
    for publisher in node.publishers:
        if publisher.topic_name == full_topic and own in names:
            names.remove(own)
    return names


class YoungBridge:
    """The same check while a bridge is young: discovery takes longer on a busy machine.

    Its own time has just begun; consecutive states far ahead of it are those of an older bridge. A
    few forged ones do not end it.
    """

    def __init__(self, node: Node, now_ns: Callable[[], int], stop: Future) -> None:
        """`now_ns` gives the bridge's own time [ns]; `stop` ends the node with the error."""
        self._node = node
        self._now_ns = now_ns
        self._stop = stop
        self._in_a_row = 0
        self._last_ns = 0  # [ns] stamp of the last state that was ahead
        self._looks = 0
        self._listener: Subscription | None = None

    def look(self) -> None:
        """Once a second: check for other bridges during the first seconds."""
        self._looks += 1
        young = self._looks <= YOUTH
        if young and self._listener is None and self._node.count_publishers(STATES) > 1:
            self._listener = self._node.create_subscription(
                JointState,
                STATES,
                guarded(self._stop, self._hear),
                CONTROL_SUBSCRIBER_QOS,
                raw=True,
            )
        elif not young and self._listener is not None:
            self._node.destroy_subscription(self._listener)
            self._listener = None

    def _hear(self, data: bytes) -> None:
        stamp_ns = read_stamp(data) if len(data) >= STAMP_END else 0
        if stamp_ns - self._now_ns() < AHEAD_NS:
            return
        follows = 0 < stamp_ns - self._last_ns <= MOST_AHEAD_NS
        self._in_a_row = self._in_a_row + 1 if follows else 0
        self._last_ns = stamp_ns
        if self._in_a_row >= IN_A_ROW:
            raise ConfigurationError(_second(self._node))

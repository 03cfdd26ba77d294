"""Who else is on the network: another bridge of the same robot, or of another one."""

from __future__ import annotations

import time

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from ghc_controller.errors import ConfigurationError
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS

DISCOVERY = 0.25  # [s] wall; a bridge that runs on this host is known by then
LISTENING = 1.0  # [s] wall; one that runs publishes at least every 50 ms, also while paused
STATES, CLOCK = "joint_states", "/clock"


def publishers_of(node: Node, topic: str) -> list[str]:
    """Full names of the nodes that publish a topic, sorted."""
    entries = node.get_publishers_info_by_topic(node.resolve_topic_name(topic))
    return sorted(f"{e.node_namespace.rstrip('/')}/{e.node_name}" for e in entries)


def refuse_second_bridge(node: Node) -> None:
    """Wait until others are known, and refuse to be the second one that publishes states.

    A publisher that is known and says nothing does not count: it was killed, and the middleware
    has not noticed yet.

    Raises:
        ConfigurationError: somebody publishes joint states here; names who.
    """
    deadline = time.monotonic() + DISCOVERY
    while not node.count_publishers(STATES):
        if time.monotonic() > deadline:
            return
        time.sleep(0.01)
    heard: list[bytes] = []
    executor = SingleThreadedExecutor(context=node.context)
    listener = Node(
        f"{node.get_name()}_check", context=node.context, namespace=node.get_namespace()
    )
    listener.create_subscription(
        JointState, STATES, heard.append, CONTROL_SUBSCRIBER_QOS, raw=True
    )
    executor.add_node(listener)
    deadline = time.monotonic() + LISTENING
    while not heard and time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.05)
    names = publishers_of(node, STATES)
    executor.shutdown()
    listener.destroy_node()
    if heard:
        raise ConfigurationError(
            f"{node.resolve_topic_name(STATES)} is published already by {', '.join(names)}: one "
            "bridge or driver per robot is expected; a second robot needs a namespace or domain "
            "of its own"
        )


def clock_belongs_to_another(node: Node) -> bool:
    """Whether a node whose name comes first in the alphabet publishes the clock as well."""
    own = f"{node.get_namespace().rstrip('/')}/{node.get_name()}"
    return any(name < own for name in publishers_of(node, CLOCK))

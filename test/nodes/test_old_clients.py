"""A node of another version is named, once, and nodes of this one are not."""

from __future__ import annotations

import time
from typing import Any

import rclpy
from ghc_msgs.msg import Tick
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import Header

from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.wire.old_clients import OldClients

DEADLINE = 60.0  # [s] wall


def test_an_old_client_is_named_once(ros_context: Any, ros_domain_id: int) -> None:
    node = Node("controller", context=ros_context)
    node.create_publisher(Tick, "ghc/tick", CONTROL_PUBLISHER_QOS)
    present = Node("present", context=ros_context)
    present.create_subscription(Tick, "ghc/tick", lambda _: None, CONTROL_SUBSCRIBER_QOS)
    elsewhere = Context()  # a participant has one type for a topic
    rclpy.init(args=[], context=elsewhere, domain_id=ros_domain_id)
    old = Node("old_generator", context=elsewhere)
    old.create_subscription(Header, "ghc/tick", lambda _: None, CONTROL_SUBSCRIBER_QOS)
    clients = OldClients(node)
    said: list[str] = []
    deadline = time.monotonic() + DEADLINE
    while not any(said) and time.monotonic() < deadline:
        said.append(clients.look())
        time.sleep(0.01)
    said += [clients.look() for _ in range(20)]
    (told,) = [words for words in said if words]
    assert "/ghc/tick: node '/old_generator' has another std_msgs/msg/Header" in told
    assert "ghc_msgs/msg/Tick of this version expected" in told
    assert "present" not in told
    for each in (node, present, old):
        each.destroy_node()
    rclpy.shutdown(context=elsewhere)

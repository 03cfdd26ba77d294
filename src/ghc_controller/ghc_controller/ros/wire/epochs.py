"""Announcements of runs of a simulated robot, so that a reset is followed at once.

Subscribes sim_bridge/epoch (latched); without a bridge the run number is 0.
"""

from __future__ import annotations

from collections.abc import Callable

from ghc_msgs.msg import Epoch
from rclpy.node import Node

from ghc_controller.ros.qos import LATCHED_QOS
from ghc_controller.ros.run import tolerant
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.ros.wire.timeline import Timeline

EPOCH_TOPIC = "sim_bridge/epoch"


def listen_to_epochs(node: Node, timeline: Timeline, reject: Callable[[str, str], object]) -> None:
    """Announce every run to `timeline`; created first, so that it is served first."""

    def announce(message: Epoch) -> None:
        timeline.announce(message.number, nanoseconds_from_time(message.start))

    take: Callable[[Epoch], None] = tolerant(announce, EPOCH_TOPIC, reject)
    node.create_subscription(Epoch, EPOCH_TOPIC, take, LATCHED_QOS)

"""Publishes a recorded run again: all its topics, and /clock, at a chosen rate.

For RViz, the viewer and tests where `ros2 bag play` is not installed. Messages are published as
the recorded bytes, in their order; a truncated recording is played up to its end.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from rosgraph_msgs.msg import Clock

from ghc_controller.errors import ConfigurationError
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import CLOCK_QOS, RECORDING_DEPTH
from ghc_controller.ros.run import guarded, run_node
from ghc_controller.ros.time import time_from_nanoseconds
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.parameters import ReplayParameters
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.playback import Pace, chosen, contents, is_latched, playback
from ghc_sim_bridge.ros.message_schema import message_class, message_schema, same_layout

NODE_NAME = "replay"
CLOCK_TOPIC = "/clock"
TICK = 0.002  # [s] wall
PATIENCE = 5.0  # [s] wall until reliable readers have the last messages


class Replay:
    """Reads the file message by message and publishes those that are due."""

    def __init__(self, stop: Future) -> None:
        """Scan the recording and announce its topics; `stop` ends the node.

        Raises:
            GhcError: a parameter or the recording cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        p = read_parameters(self.node, ReplayParameters)
        self.executor = p.executor
        path = Path(p.recording).expanduser()
        held = contents(path)
        if p.start * NANOSECONDS > held.duration:
            raise ConfigurationError(
                f"parameter 'start': {p.start:g} s given, the recording lasts "
                f"{held.duration / NANOSECONDS:g} s"
            )
        self._publishers = self._announce(chosen(held, p.topics))
        if not self._publishers:
            raise ConfigurationError(f"recording '{path}': no topic of it can be replayed")
        self._own_clock = (
            None
            if CLOCK_TOPIC in self._publishers
            else self.node.create_publisher(Clock, CLOCK_TOPIC, CLOCK_QOS)
        )
        names = frozenset(self._publishers)
        self._pace = Pace(partial(playback, path, names, p.start), p.rate, p.loop)
        self._begin = time.monotonic() + p.delay
        self._stop = stop
        self.node.get_logger().info(
            f"{path}: {held.messages} messages, {held.duration / NANOSECONDS:.3f} s; "
            f"{len(names)} of {len(held.topics)} topics are replayed"
        )
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(TICK, guarded(stop, self._on_tick), clock=wall)

    def _announce(self, topics: dict[str, BagTopic]) -> dict[str, Publisher]:
        publishers = {}
        for name, topic in topics.items():
            try:
                kind = message_class(topic.type_name)
                if not same_layout(topic.schema, message_schema(topic.type_name)):
                    raise ConfigurationError(
                        f"the fields of {topic.type_name} have changed since it was recorded"
                    )
            except ConfigurationError as error:
                self.node.get_logger().warning(f"{name} is not replayed: {error}")
                continue
            publishers[name] = self.node.create_publisher(kind, name, replay_qos(topic))
        return publishers

    def _on_tick(self) -> None:
        if time.monotonic() < self._begin or self._stop.done():
            return
        last = None
        for entry in self._pace.due(time.monotonic_ns()):
            if self._own_clock is not None and entry.log_time != last:
                self._own_clock.publish(Clock(clock=time_from_nanoseconds(entry.log_time)))
                last = entry.log_time
            self._publishers[entry.topic].publish(entry.data)
        if self._pace.done:
            self._stop.set_result(None)

    def close(self) -> None:
        """Wait until reliable readers have the last messages."""
        deadline = time.monotonic() + PATIENCE
        for publisher in self._publishers.values():
            left = max(deadline - time.monotonic(), 0.0)
            publisher.wait_for_all_acked(Duration(seconds=left))


def replay_qos(topic: BagTopic) -> QoSProfile:
    """Reliable, so that every reader matches, latched if it was, and deep: messages come in
    bursts."""
    latched = is_latched(topic)
    depth = max((int(qos.get("depth", 1)) for qos in topic.offered_qos), default=1)
    return QoSProfile(
        depth=max(depth, 1) if latched else max(depth, RECORDING_DEPTH),
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def main(args: Sequence[str] | None = None) -> int:
    """Replay until the end or a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, Replay, args)


if __name__ == "__main__":
    sys.exit(main())

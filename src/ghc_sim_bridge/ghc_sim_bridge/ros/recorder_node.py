"""Records every topic to a rosbag2 folder, in a separate process.

The folder can be opened at any time, also after a kill: received messages are written to disk
twice a second. A full disk ends the recording, not the run.

Topics are found as they appear, whatever their names and types. Messages are kept as serialized
bytes. Fast topics are thinned to a grid of simulated time, unless record_mode is `full`: then
every message is kept, and the bridge's parameter `lossless` makes it wait for this reader rather
than lose one.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.subscription import Subscription
from rclpy.task import Future

from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.process.freed_memory import return_freed_memory
from ghc_controller.ros.qos import recording_qos
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import guarded, run_node
from ghc_controller.ros.wire.cdr import STAMP_END, read_stamp
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.parameters import RecorderParameters
from ghc_sim_bridge.recorder.bag_metadata import BagTopic
from ghc_sim_bridge.recorder.decimation import Decimator
from ghc_sim_bridge.recorder.kept_recording import KeptRecording
from ghc_sim_bridge.ros.message_schema import message_class, message_schema
from ghc_sim_bridge.ros.offered_qos import offered_qos, type_hash

NODE_NAME = "recorder"
DISCOVERY_PERIOD = 0.1  # [s] wall
TRIM_PERIOD = 10.0  # [s] wall, between two times that memory of written chunks is given back
GRACE = 0.3  # [s] wall for the last messages of nodes that end together with this one
BACKLOG = 300  # [-] messages found waiting at once: this reader was behind, there may be more
PATIENCE = 8.0  # [s] wall for all of them
CLOCK_TOPIC = "/clock"
# Fast topics by their last name, and by the one before it for topics like contacts/<name>. All
# of them begin with a stamp; a topic of such a name that does not is not thinned.
FAST_NAMES = frozenset({"joint_states", "joint_commands", "clock", "odom", "controller_state"})
FAST_FOLDERS = frozenset({"contacts"})
Receive = Callable[[bytes], None]


def is_fast(topic: str) -> bool:
    """Whether `topic` is published once per control period."""
    folder, _, name = topic.rpartition("/")
    return name in FAST_NAMES or folder.rpartition("/")[2] in FAST_FOLDERS


class Recorder:
    """Subscribes to topics as they appear and passes the bytes to the recording."""

    def __init__(self, stop: Future) -> None:
        """Open the file and look for topics.

        `stop` ends the node, also with an error from writing. Raises GhcError or OSError when
        a parameter or the file cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._parameters = p = read_parameters(self.node, RecorderParameters)
        self.executor = p.executor
        if p.output.endswith(".mcap"):
            raise InvalidValue(f"'output' is a folder, such as {p.output.removesuffix('.mcap')}")
        self._recording = KeptRecording(Path(p.output), self.node.get_logger().error)
        self._stop = stop
        self._rejections = Rejections()
        self._known: set[str] = set()
        self._listeners: list[tuple[Subscription, type, Receive]] = []
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        self.node.create_timer(DISCOVERY_PERIOD, guarded(stop, self._on_timer), clock=wall)
        self.node.create_timer(TRIM_PERIOD, return_freed_memory, clock=wall)
        self._discover()

    def _on_timer(self) -> None:
        self._discover()
        self._recording.checkpoint_if_due()

    def _discover(self) -> None:
        for topic, types in self.node.get_topic_names_and_types():
            if topic not in self._known and self.node.count_publishers(topic) > 0:
                self._known.add(topic)
                self._subscribe(topic, types[0])

    def _subscribe(self, topic: str, type_name: str) -> None:
        try:
            kind, schema = message_class(type_name), message_schema(type_name)
        except ConfigurationError as error:
            self.node.get_logger().warning(f"{topic} is not recorded: {error}")
            return
        fast = is_fast(topic) and _begins_with_stamp(kind)
        full = self._parameters.record_mode == "full"
        offers = self.node.get_publishers_info_by_topic(topic)
        qos = recording_qos([offer.qos_profile for offer in offers], lossless=full or not fast)
        self._recording.add_topic(
            BagTopic(topic, type_name, schema, offered_qos(offers), type_hash(offers))
        )
        decimator = (
            Decimator(round(NANOSECONDS / self._parameters.fast_rate))
            if fast and not full
            else None
        )
        receive = partial(self._receive, topic, decimator)
        listener = self.node.create_subscription(
            kind, topic, guarded(self._stop, receive), qos, raw=True
        )
        self._listeners.append((listener, kind, receive))

    def _receive(self, topic: str, decimator: Decimator | None, data: bytes) -> None:
        # EventsExecutor of Jazzy fails on callbacks that ask for the middleware's time stamps.
        stamp_ns = read_stamp(data) if len(data) >= STAMP_END else None
        if topic == CLOCK_TOPIC and stamp_ns is not None:
            self._take_clock(stamp_ns)
        # Messages too short for a stamp are not thinned.
        if decimator is None or stamp_ns is None or decimator.keeps(stamp_ns):
            self._recording.write(topic, data)

    def _take_clock(self, stamp_ns: int) -> None:
        """Simulated time is `stamp_ns` [ns]; the format of the file has no negative times."""
        if stamp_ns >= 0:
            self._recording.clock(stamp_ns)
        elif self._rejections.count(CLOCK_TOPIC, time.monotonic()):
            self.node.get_logger().warning(
                f"{CLOCK_TOPIC}: {stamp_ns * 1e-9:g} s given, 0 or more expected; the recording "
                "goes on at the time before"
            )

    def close(self) -> None:
        """Receive pending messages, and write the file's index."""
        began = time.monotonic()
        end = began + GRACE
        while time.monotonic() < end:
            if self._take_waiting() > BACKLOG:
                end = min(time.monotonic() + GRACE, began + PATIENCE)
            self._recording.checkpoint_if_due()
            time.sleep(0.01)
        self._recording.close()

    def _take_waiting(self) -> int:
        """Receive pending messages without an executor; returns their number."""
        count = 0
        for listener, kind, receive in self._listeners:
            with listener.handle:
                while (taken := listener.handle.take_message(kind, True)) is not None:
                    receive(taken[0])
                    count += 1
        return count


def _begins_with_stamp(kind: Any) -> bool:
    """Whether the first field of a message class is a header or a time."""
    types = list(kind.get_fields_and_field_types().values())
    return bool(types) and types[0] in ("std_msgs/Header", "builtin_interfaces/Time")


def main(args: Sequence[str] | None = None) -> int:
    """Record until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, Recorder, args)


if __name__ == "__main__":
    sys.exit(main())

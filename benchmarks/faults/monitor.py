"""Independent monitor: a process that records serialized joint states and commands.

It shares nothing with the nodes under test: it listens, and writes one .npz when it is stopped.
`python -m benchmarks.faults.monitor FILE` in the ROS domain of the run.
"""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from sensor_msgs.msg import JointState

from ghc_controller.ros.run import make_executor

READY = "monitor: listening"
_QOS = QoSProfile(depth=2000, reliability=ReliabilityPolicy.RELIABLE)
_NANOSECONDS = 1_000_000_000


def main(path: str) -> int:
    """Record until a signal; 0."""
    stopped: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda given, _frame: stopped.append(given))
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = Node("fault_monitor")
    raw: dict[str, list[tuple[int, bytes]]] = {"joint_states": [], "joint_commands": []}
    for topic, seen in raw.items():
        node.create_subscription(JointState, topic, _keeper(seen), _QOS, raw=True)
    executor = make_executor("events")
    executor.add_node(node)
    told = False
    while not stopped:
        executor.spin_until_future_complete(Future(), 0.05)
        if not told and all(raw.values()):
            print(READY, flush=True)
            told = True
    columns: dict[str, Any] = {}
    for topic, seen in raw.items():
        columns |= _columns(topic, seen)
    np.savez_compressed(Path(path), **columns)
    rclpy.try_shutdown()
    return 0


def _keeper(seen: list[tuple[int, bytes]]) -> Callable[[bytes], None]:
    def keep(data: bytes) -> None:
        seen.append((time.monotonic_ns(), data))

    return keep


def _columns(topic: str, seen: list[tuple[int, bytes]]) -> dict[str, Any]:
    """Wall time [ns], stamp [ns] and numbers of the messages that are laid out as the first one.

    The injector names joints in another order, so that its own messages are not taken for the
    robot's: they are counted as `others`.
    """
    rows: list[tuple[int, int, list[float], list[float], list[float]]] = []
    others = 0
    names: list[str] = []
    for wall, data in seen:
        try:
            message = deserialize_message(data, JointState)
        except Exception:  # the middleware's own type, whatever it is
            others += 1
            continue
        names = names or list(message.name)
        size = len(names)
        if list(message.name) != names or len(message.effort) != size:
            others += 1
            continue
        stamp = message.header.stamp.sec * _NANOSECONDS + message.header.stamp.nanosec
        numbers = [
            list(field) or [0.0] * size
            for field in (message.position, message.velocity, message.effort)
        ]
        rows.append((wall, stamp, *numbers))
    fields = ("wall", "stamp", "position", "velocity", "effort")
    columns = list(zip(*rows, strict=True)) or [()] * len(fields)
    answer: dict[str, Any] = {
        f"{topic}_{name}": np.array(column) for name, column in zip(fields, columns, strict=True)
    }
    return answer | {f"{topic}_others": others}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))

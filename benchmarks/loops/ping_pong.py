"""A bare rclpy loop: two nodes that send the bytes of a joint state and of a command in turns.

`python -m benchmarks.loops.ping_pong pong` answers; `ping RESULT DURATION [PERIOD]` asks, at once
after each answer or at the beginning of each period, and writes what it counted as JSON.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState

from ghc_controller.ros.process.scheduling import Scheduling
from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.run import make_executor, spin_until
from ghc_controller.ros.wire.cdr import read_stamp
from ghc_controller.ros.wire.joint_state import JointStateEncoder

JOINTS = tuple(f"joint_{i}" for i in range(1, 8))  # as many as KUKA has, of the same names
_SENDER = "controller_01234567"
_REPEAT = 0.05  # [s] without an answer: the message or its answer was lost
_SETTLING = 500  # rounds at the start: discovery, first calls


class Ping:
    """Asks and counts."""

    def __init__(self, node: Node, result: Path, duration: float, period: float, stop: Future):
        """`period` [s], 0: ask as soon as the answer is there. `duration` [s] after settling."""
        self._result, self._duration, self._period, self._stop = result, duration, period, stop
        self._encoder = JointStateEncoder(JOINTS, "0")
        self._publisher = node.create_publisher(JointState, "ping", CONTROL_PUBLISHER_QOS)
        node.create_subscription(JointState, "pong", self._take, CONTROL_SUBSCRIBER_QOS, raw=True)
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(period or _REPEAT, self._on_time, clock=wall)
        self._sent = self._answered = self._rounds = self._lost = 0
        self._sent_at = self._since = time.monotonic()
        self._due_at = self._since + period
        self._numbers = np.zeros(len(JOINTS))

    def _send(self) -> None:
        self._sent += 1
        self._sent_at = time.monotonic()
        self._publisher.publish(self._encoder.encode(self._sent, *[self._numbers] * 3))

    def _take(self, data: bytes) -> None:
        self._answered = read_stamp(data)
        if not self._period and self._answered == self._sent:
            self._count(lost=False)
            self._send()

    def _on_time(self) -> None:
        now = time.monotonic()
        if not self._period:
            if now - self._sent_at > _REPEAT:
                self._send()
            return
        while self._due_at <= now:  # after a delay several: only the last can be answered
            self._due_at += self._period
            self._count(lost=self._answered < self._sent)
            self._send()

    def _count(self, *, lost: bool) -> None:
        if not self._answered:  # the other one is not there yet
            return
        self._rounds += 1
        self._lost += lost
        if self._rounds == _SETTLING:
            self._since, self._lost = time.monotonic(), 0
        took = time.monotonic() - self._since
        if self._rounds > _SETTLING and took >= self._duration and not self._stop.done():
            rounds = self._rounds - _SETTLING
            counted = {"rounds": rounds, "lost": self._lost, "seconds": took}
            self._result.write_text(json.dumps(counted), encoding="utf-8")
            self._stop.set_result(None)


def main() -> None:
    """See the module."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("side", choices=("ping", "pong"))
    parser.add_argument("result", type=Path, nargs="?")
    parser.add_argument("duration", type=float, nargs="?", default=1.0)
    parser.add_argument("period", type=float, nargs="?", default=0.0)
    parser.add_argument("--priority", type=int, default=0)
    options = parser.parse_args()
    rclpy.init()
    node, stop = Node(options.side), Future()
    asking = None
    if options.side == "ping":
        asking = Ping(node, options.result, options.duration, options.period, stop)
    else:
        encoder = JointStateEncoder(JOINTS, _SENDER, motion=False)
        publisher = node.create_publisher(JointState, "pong", CONTROL_PUBLISHER_QOS)
        numbers = np.zeros(len(JOINTS))

        def answer(data: bytes) -> None:
            publisher.publish(encoder.encode(read_stamp(data), numbers))

        node.create_subscription(JointState, "ping", answer, CONTROL_SUBSCRIBER_QOS, raw=True)
    Scheduling(realtime_priority=options.priority).apply()
    executor = make_executor("events")
    executor.add_node(node)
    try:
        spin_until(executor, stop)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # ended by the benchmark
    finally:
        executor.remove_node(node)
        executor.shutdown()
        del asking
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

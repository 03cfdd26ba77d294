"""Stands for a robot and for RViz in tests: sends states, keeps transforms and markers."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, LATCHED_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_sim_bridge.ros.display.transforms import STATIC_TF_QOS

PATIENCE = 90.0  # [s] wall


class Display:
    """The other end of display_publisher."""

    def __init__(self, context: Any, space: str = "") -> None:
        self.node = Node("display", context=context, namespace=space)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.transforms: dict[str, tuple[str, pin.SE3, int]] = {}  # child -> parent, place, stamp
        self.arrays: list[MarkerArray] = []
        self.descriptions: list[str] = []
        self.count = 0  # of /tf
        self._publishers: dict[str, Any] = {}
        node = self.node
        node.create_subscription(TFMessage, "/tf", self._on_tf, 100)
        node.create_subscription(TFMessage, "/tf_static", self._on_tf, STATIC_TF_QOS)
        node.create_subscription(MarkerArray, "ghc/markers", self.arrays.append, 10)
        node.create_subscription(
            String, "robot_description", lambda m: self.descriptions.append(m.data), LATCHED_QOS
        )

    def send(self, topic: str, message: Any, seconds: float = 1.0) -> None:
        """Publish with a stamp."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(
                type(message), topic, CONTROL_PUBLISHER_QOS
            )
        message.header.stamp = time_from_seconds(seconds)
        self._publishers[topic].publish(message)

    def until(self, done: Callable[[], Any], again: Callable[[], Any] = lambda: None) -> None:
        """Spin until something holds; `again` before each look."""
        deadline = time.monotonic() + PATIENCE
        while not done():
            again()
            self.spin(0.05)
            assert time.monotonic() < deadline

    def spin(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.01)

    def place(self, frame: str) -> pin.SE3:
        """Of a frame in the world, by the transforms that came."""
        if frame == "world":
            return pin.SE3.Identity()
        parent, own, _ = self.transforms[frame]
        return self.place(parent) * own

    def marks(self, group: str) -> list[Marker]:
        """Markers of a namespace in the newest array, but not the ones removed."""
        newest = self.arrays[-1].markers if self.arrays else []
        return [mark for mark in newest if mark.ns == group and mark.action == Marker.ADD]

    def _on_tf(self, message: TFMessage) -> None:
        self.count += 1
        for entry in message.transforms:
            t, r = entry.transform.translation, entry.transform.rotation
            turn = pin.Quaternion(r.w, r.x, r.y, r.z)
            own = pin.SE3(turn, np.array([t.x, t.y, t.z]))
            stamp = nanoseconds_from_time(entry.header.stamp)
            self.transforms[entry.child_frame_id] = (entry.header.frame_id, own, stamp)

    def close(self) -> None:
        self._executor.shutdown()
        self.node.destroy_node()

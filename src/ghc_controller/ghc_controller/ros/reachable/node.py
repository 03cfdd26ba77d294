"""Target streams behind ROS topics: poses or points in, references that the robot can follow out.

Publishes  ghc/task_reference (at `period` of the robot's time while the reference moves),
           /diagnostics.
Subscribes joint_states (time, and where the robot is at the start), sim_bridge/epoch (latched),
           odom (where a floating base is when a motion begins),
           targets/<task> (PoseStamped), target_points/<task> (PointStamped; tasks of a position
           only).
Parameters see ReachableTargetsParameters.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped, PoseStamped
from ghc_msgs.msg import TaskReference
from nav_msgs.msg import Odometry
from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState

from ghc_controller.errors import GhcError, InvalidValue
from ghc_controller.reachable import ReachableReference
from ghc_controller.references.follower import ReferenceSpace
from ghc_controller.robot.library import load_robot
from ghc_controller.ros.conversions.common import check_frame, diagnostics_message
from ghc_controller.ros.conversions.states import base_from_bytes, read_joint_state
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, RELIABLE_QOS, STREAM_QOS
from ghc_controller.ros.reachable.messages import (
    check_kind,
    reference_message,
    stamp_of,
    target_of,
)
from ghc_controller.ros.reachable.parameters import ReachableTargetsParameters
from ghc_controller.ros.rejections import Rejections
from ghc_controller.ros.run import run_node, tolerant
from ghc_controller.ros.wire.epochs import listen_to_epochs
from ghc_controller.ros.wire.joint_state import JointStateDecoder
from ghc_controller.ros.wire.joint_state_reader import JointStateReader
from ghc_controller.ros.wire.timeline import Place, Timeline
from ghc_controller.safety.plausibility import StatePlausibility
from ghc_controller.types import NANOSECONDS, Array

NODE_NAME = "reachable_targets"
_DIAGNOSTICS_PERIOD = 1.0  # [s] wall
_MOST_AHEAD_NS = NANOSECONDS  # [ns] between two states; some are lost in a fast run


class ReachableTargetsNode:
    """Wires topics to the library; no arithmetic here."""

    _base: Array | None  # (13,) of a floating base, as last measured

    def __init__(self, stop: Future) -> None:  # noqa: ARG002 - no message stops it
        """Read the parameters, load the robot, subscribe.

        Raises:
            GhcError: a parameter, or a file that it names, cannot be used.
        """
        self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        self._parameters = p = read_parameters(self.node, ReachableTargetsParameters)
        self.executor = p.executor
        robot = load_robot(p.robot)
        tasks = p.tasks or (robot.tasks[0].name,)
        self._reference = ReachableReference(robot, tasks, p.settings, p.posture)
        for stream in self._reference.streams.values():
            check_kind(stream.task)
        self._floating, self._base = robot.floating_base, None
        self._reader = JointStateReader(robot.model.joint_names)
        self._decoder = JointStateDecoder(read_joint_state)
        self._plausibility = StatePlausibility(robot.model.joint_names, robot.model.limits)
        self._timeline = Timeline(_MOST_AHEAD_NS)
        self._rejections = Rejections()
        self._period_ns = round(p.settings.period * NANOSECONDS)
        self._now_ns = -1  # of the last state
        self._due_ns = 0  # of the next plan
        self._samples = self._plans = 0
        self._publish_and_listen()
        self.node.get_logger().info(f"{p.robot}: targets of {', '.join(tasks)}: ready")

    def _publish_and_listen(self) -> None:
        node = self.node
        self._out = node.create_publisher(TaskReference, "ghc/task_reference", RELIABLE_QOS)
        self._diagnostics = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        listen_to_epochs(node, self._timeline, self._reject)
        node.create_subscription(
            JointState,
            "joint_states",
            tolerant(self._on_state, "joint_states", self._reject),
            CONTROL_SUBSCRIBER_QOS,
            raw=True,
        )
        if self._floating:
            take_base: Callable[[Any], None] = tolerant(self._on_base, "odom", self._reject)
            node.create_subscription(Odometry, "odom", take_base, CONTROL_SUBSCRIBER_QOS, raw=True)
        for name, stream in self._reference.streams.items():
            kinds: list[tuple[type, str]] = [(PoseStamped, f"targets/{name}")]
            if stream.task.space is ReferenceSpace.VECTOR:
                kinds.append((PointStamped, f"target_points/{name}"))
            for kind, topic in kinds:
                take: Callable[[Any], None] = tolerant(
                    partial(self._on_target, topic, name), topic, self._reject
                )
                node.create_subscription(kind, topic, take, STREAM_QOS)
        wall = RosClock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(_DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=wall)

    def _on_base(self, data: bytes) -> None:
        try:
            self._base = base_from_bytes(data)
        except InvalidValue as error:
            self._reject("odom", str(error))

    def _on_state(self, data: bytes) -> None:
        if self._floating and self._base is None:
            self._reject("joint_states", "no odom came yet: where the base is is not known")
            return
        try:
            values = self._decoder.decode(data)
            state = self._reader.read(values, self._timeline.epoch, {}, self._base)
        except (InvalidValue, ValueError) as error:
            self._reject("joint_states", str(error))
            return
        place = self._timeline.judge(values.stamp_ns)
        if place in (Place.OLDER, Place.ELSEWHERE):
            self._reject("joint_states.stamp", self._timeline.expected())
            return
        if place is Place.RESTARTED:
            self._reference.reset()
            self._plausibility.reset()
            self._due_ns = 0
        elif place is Place.RESUMED:
            self._plausibility.resume()
        try:
            self._plausibility.check(state)  # a plan begins where the robot is
        except InvalidValue as error:
            self._reject(str(error).split(":")[0], str(error))
            return
        self._now_ns = stamp_ns = values.stamp_ns
        if stamp_ns < self._due_ns:
            return
        self._due_ns = stamp_ns - stamp_ns % self._period_ns + self._period_ns
        for reference in self._reference.plan(state):
            self._out.publish(reference_message(reference))
            self._plans += 1

    def _on_target(self, topic: str, name: str, message: PoseStamped | PointStamped) -> None:
        if self._now_ns < 0:
            self._reject(topic, "no joint_states came yet: the robot's time is not known")
            return
        stream = self._reference.streams[name]
        now = self._now_ns / NANOSECONDS
        try:
            check_frame(message.header.frame_id, self._parameters.world_frame)
            stamp = stamp_of(message) if self._parameters.stamps == "header" else None
            self._reference.add(name, target_of(message, stream.task), now, stamp)
            self._samples += 1
        except GhcError as error:
            self._reject(topic, str(error))

    def _reject(self, field: str, reason: str) -> None:
        if self._rejections.count(field, time.monotonic()):
            self.node.get_logger().warning(f"{field}: {reason}")

    def _publish_diagnostics(self) -> None:
        rejected = {f"rejected_{field}": n for field, n in self._rejections.counts.items()}
        reference = self._reference
        values = {
            "samples": self._samples,
            "jumps": sum(stream.jumps for stream in reference.streams.values()),
            "references": self._plans,
            **rejected,
        }
        summary = "following" if reference.has_begun else "no target yet"
        if self._now_ns < 0:
            summary = "no joint_states"
        self._diagnostics.publish(
            diagnostics_message(max(self._now_ns, 0), NODE_NAME, summary, self._now_ns < 0, values)
        )

    def close(self) -> None:
        """No resources to release."""


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, ReachableTargetsNode, args)


if __name__ == "__main__":
    sys.exit(main())

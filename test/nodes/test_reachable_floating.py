"""reachable_targets with a floating base: targets in the world, the base where odom says."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PointStamped
from ghc_msgs.msg import TaskReference
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from ghc_controller.robot.library import load_robot
from ghc_controller.ros.qos import CONTROL_PUBLISHER_QOS, RELIABLE_QOS
from ghc_controller.ros.time import time_from_nanoseconds

DEADLINE = 120.0  # [s] wall
PERIOD = 20_000_000  # [ns] of states and targets
BASE = np.array([0.3, -0.2, 0.6, 0.0, 0.0, np.sin(0.6), np.cos(0.6)])  # turned by 1.2 rad
ARM = {"l_shoulder_pitch": -0.5, "l_shoulder_roll": 0.5, "l_elbow": 1.0, "r_elbow": 1.0}  # [rad]
WAY = np.array([0.02, 0.03, 0.05])  # [m] from the hand to its target


class Standing:
    """An iCub that does not move, and an operator of its hand."""

    def __init__(self, context: Any) -> None:
        self.robot = load_robot("icub")
        model = self.robot.model
        q = model.q.copy()
        q[:7] = BASE
        for name, value in ARM.items():
            q[7 + model.joint_names.index(name)] = value
        model.update(q, np.zeros(model.nv))
        task = next(task for task in self.robot.tasks if task.name == "left_hand")
        self.hand = task.current(model).copy()
        self.target = self.hand + WAY
        self.node = Node("standing", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        publish = self.node.create_publisher
        self._states = publish(JointState, "joint_states", CONTROL_PUBLISHER_QOS)
        self._base = publish(Odometry, "odom", CONTROL_PUBLISHER_QOS)
        self._points = publish(PointStamped, "target_points/left_hand", 10)
        self.references: list[TaskReference] = []
        self.node.create_subscription(
            TaskReference, "ghc/task_reference", self.references.append, RELIABLE_QOS
        )
        zeros = [0.0] * model.na
        self._state = JointState(
            name=list(model.joint_names), position=q[7:].tolist(), velocity=zeros, effort=zeros
        )
        self._now = 0  # [ns]

    def send(self, with_base: bool) -> None:
        """The next state, with the pose of the base or without, and a target of the one before."""
        before = time_from_nanoseconds(self._now)
        self._now += PERIOD
        stamp = time_from_nanoseconds(self._now)
        if with_base:
            odom = Odometry()
            odom.header.stamp = stamp
            pose = odom.pose.pose
            pose.position.x, pose.position.y, pose.position.z = BASE[:3].tolist()
            turn = pose.orientation
            turn.x, turn.y, turn.z, turn.w = BASE[3:].tolist()
            self._base.publish(odom)
        self._state.header.stamp = stamp
        self._states.publish(self._state)
        point = PointStamped()
        point.header.stamp = before
        point.point.x, point.point.y, point.point.z = self.target.tolist()
        self._points.publish(point)

    def send_until(self, condition: Callable[[], Any], with_base: bool, what: str) -> None:
        """A state per answer, or per 0.1 s where none comes: the node must not be left behind."""
        deadline = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < deadline, what
            self.send(with_base)
            known, due = len(self.references), time.monotonic() + 0.1
            while len(self.references) == known and time.monotonic() < due:
                self._executor.spin_once(timeout_sec=0.02)


@pytest.fixture
def standing(ros_context: Any) -> Any:
    standing = Standing(ros_context)
    yield standing
    standing.node.destroy_node()


def test_a_hand_on_a_floating_base_goes_to_its_target_in_the_world(
    standing: Standing, start_node: Any
) -> None:
    """No plan before odom; then from the hand, as the base stands and turns, to the target."""
    words = ("-p", "robot:=icub", "-p", "tasks:=[left_hand]")
    node = start_node("ghc_controller", "reachable_targets", "--ros-args", *words)
    node.wait_for_output("ready", DEADLINE)
    standing.send_until(lambda: "no odom came yet" in node.output, False, "odom is not missed")
    assert not standing.references
    sent = standing.references
    standing.send_until(lambda: sent, True, "no reference")
    first = np.array(sent[0].points[0].position)
    assert np.abs(first - standing.hand).max() < 5e-3

    def arrived() -> bool:
        last = np.array(sent[-1].points[-1].position)
        return bool(np.abs(last - standing.target).max() < 1e-3)

    standing.send_until(arrived, True, "the reference did not come to the target")
    assert all(message.task == "left_hand" for message in sent if message.task != "posture")
    assert node.stop() == 0

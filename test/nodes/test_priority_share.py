"""priority_share as a process: the task of a hand gives way as an obstacle comes near."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from ghc_msgs.msg import ControllerState, TaskReference, TaskReferencePoint, TaskState
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from benchmarks.upper_body_cases import FULL, RELEASED
from ghc_controller.hierarchy.distance_share import DistanceShare
from ghc_controller.hierarchy.hierarchy_string import parse_levels
from ghc_controller.ros.qos import RELIABLE_QOS, STREAM_QOS
from ghc_controller.ros.time import nanoseconds_from_time

DEADLINE = 120.0  # [s] wall
SCENE = ("-p", "scene:=icub_upper_body", "-p", f"lockstep_timeout:={DEADLINE}")
FAR, NEAR = [-0.058223, -0.276419, -0.249814], [-0.112484, -0.160163, -0.000936]  # [m] obstacle
TIMES = (0.0, 1.0, 1.3, 2.0)  # [s] after the first one
SHARE = DistanceShare(0.01, 0.035)  # gap of the elbow from 70 to 45 mm


class Witness:
    """Sends the obstacle on its way and notes shares and errors."""

    def __init__(self, context: Any) -> None:
        self.node = Node("witness", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.rows: list[tuple[float, float, float, float]] = []  # [s], share, errors
        self.obstacle = self.node.create_publisher(
            TaskReference, "ghc/task_reference", RELIABLE_QOS
        )
        self.node.create_subscription(
            ControllerState, "ghc/controller_state", self._on_state, STREAM_QOS
        )

    def send_obstacle(self) -> None:
        for task in ("torso_avoidance", "elbow_avoidance"):
            message = TaskReference(task=task)
            for after, place in zip(TIMES, (FAR, NEAR, NEAR, FAR), strict=True):
                start = Duration(sec=int(after), nanosec=round(1e9 * (after % 1.0)))
                message.points.append(TaskReferencePoint(time_from_start=start, position=place))
            self.obstacle.publish(message)

    def _on_state(self, message: ControllerState) -> None:
        errors = {task.name: task for task in message.tasks}
        released = [
            share
            for text, share in zip(message.mixture, message.shares, strict=True)
            if parse_levels(text) == parse_levels(RELEASED)
        ]
        now = nanoseconds_from_time(message.header.stamp) * 1e-9
        elbow, hand = errors["elbow_avoidance"].error[0], errors["hand"].error_norm
        self.rows.append((now, sum(released), elbow, hand))

    def until(self, condition: Any, what: str) -> None:
        deadline = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < deadline, what
            self._executor.spin_once(timeout_sec=0.05)


@pytest.fixture
def witness(ros_context: Any) -> Any:
    witness = Witness(ros_context)
    yield witness
    witness.node.destroy_node()


def test_the_share_follows_the_gap_of_the_elbow(witness: Witness, start_node: Any) -> None:
    """It rises as the obstacle comes, falls as it goes, and follows the gap in between."""
    robot = ("--ros-args", "-p", "robot:=icub_upper_body")
    orders = ("-p", f"first:={FULL}", "-p", f"second:={RELEASED}")
    values = ("-p", "task:=elbow_avoidance", "-p", "begins:=0.01", "-p", "ends:=0.035")
    share = start_node("ghc_controller", "priority_share", "--ros-args", *orders, *values)
    controller = start_node("ghc_controller", "controller", *robot, "-p", "arming:=automatic")
    share.wait_for_output("ready", DEADLINE)
    controller.wait_for_output("ready", DEADLINE)
    witness.until(lambda: witness.obstacle.get_subscription_count() > 0, "no controller")
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *SCENE)
    witness.until(lambda: len(witness.rows) > 5, "no controller_state")
    begin = witness.rows[-1][0]
    witness.send_obstacle()
    witness.until(lambda: witness.rows[-1][2] > SHARE.begins, "the obstacle did not come")
    witness.until(lambda: witness.rows[-1][0] > begin + 3.0, "the run did not go on")
    rows = np.array(witness.rows)
    share_of, elbow = rows[:, 1], rows[:, 2]
    wanted = np.array([SHARE.wanted(value) for value in elbow])
    assert share_of.max() > 0.2
    assert share_of[-1] == 0.0
    assert np.abs(share_of[5:] - wanted[:-5]).mean() < 0.05  # 50 ms late
    assert np.corrcoef(share_of[5:], wanted[:-5])[0, 1] > 0.9
    assert rows[-1, 3] < 0.02  # [m] the hand is on its way back


def test_a_report_that_is_none_does_not_end_the_node(ros_context: Any, start_node: Any) -> None:
    """Anyone can send one: shares without a mixture are rejected with the reason."""
    orders = ("-p", f"first:={FULL}", "-p", f"second:={RELEASED}")
    values = ("-p", "task:=hand", "-p", "begins:=0.01", "-p", "ends:=0.035")
    share = start_node("ghc_controller", "priority_share", "--ros-args", *orders, *values)
    sender = Node("sender", context=ros_context)
    reports = sender.create_publisher(ControllerState, "ghc/controller_state", STREAM_QOS)
    forged = ControllerState(tasks=[TaskState(name="hand", error=[0.0])], shares=[1.0])
    deadline = time.monotonic() + DEADLINE
    while "message rejected" not in share.output:
        assert time.monotonic() < deadline and share.exit_code is None, share.output
        reports.publish(forged)
        time.sleep(0.05)
    sender.destroy_node()
    assert share.stop() == 0, share.output

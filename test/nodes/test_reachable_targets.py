"""reachable_targets as a process: between an operator's stream and controller and bridge."""

from __future__ import annotations

import copy
import signal
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PointStamped, PoseStamped
from ghc_msgs.msg import ControllerState, TaskReference
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, RELIABLE_QOS, STREAM_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds

DEADLINE = 120.0  # [s] wall
ARM = ("-p", "scene:=kuka_lwr", "-p", f"lockstep_timeout:={DEADLINE}")
GOAL = np.array([0.45, 0.25, 0.6])  # [m]
PERIOD = 20_000_000  # [ns] of the stream
FORGED = (2**31 - 1) * 1_000_000_000  # [ns] a stamp that is not the robot's


class Operator:
    """Sends targets in the robot's time and looks at what becomes of them."""

    def __init__(self, context: Any) -> None:
        self.node = Node("operator", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.references: list[TaskReference] = []
        self.diagnostics: dict[str, str] = {}
        self.error = np.inf  # [m] of the end effector
        self.reference = np.zeros(3)
        self.sends = False
        self._due = 0
        self.now = -1  # [ns]
        self.goal = GOAL
        self.state = JointState()
        listen = self.node.create_subscription
        self.poses = self.node.create_publisher(PoseStamped, "targets/end_effector", 10)
        self.points = self.node.create_publisher(PointStamped, "target_points/end_effector", 10)
        self.states = self.node.create_publisher(JointState, "joint_states", 10)
        listen(JointState, "joint_states", self._on_state, CONTROL_SUBSCRIBER_QOS)
        listen(TaskReference, "ghc/task_reference", self.references.append, RELIABLE_QOS)
        listen(ControllerState, "ghc/controller_state", self._on_controller, STREAM_QOS)
        listen(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)

    def _on_state(self, message: JointState) -> None:
        stamp = nanoseconds_from_time(message.header.stamp)
        if stamp == FORGED:
            return
        self.now, self.state = stamp, message
        if self.sends and self.now >= self._due:
            self._due = self.now + PERIOD
            self.poses.publish(self.pose(self.goal))

    def pose(self, position: np.ndarray, frame: str = "") -> PoseStamped:
        message = PoseStamped()
        message.header.stamp = time_from_nanoseconds(self.now)
        message.header.frame_id = frame
        target = message.pose.position
        target.x, target.y, target.z = (float(value) for value in position)
        return message

    def forge_states_until(self, condition: Callable[[], Any], what: str) -> None:
        """The last state, as if it came from the end of time; again, since one may be lost."""
        forged = copy.deepcopy(self.state)
        forged.header.stamp = time_from_nanoseconds(FORGED)
        due = 0.0

        def met() -> bool:
            nonlocal due
            if time.monotonic() >= due:
                self.states.publish(forged)
                due = time.monotonic() + 0.5  # [s] true states come between
            return bool(condition())

        self.until(met, what)

    def _on_controller(self, message: ControllerState) -> None:
        for task in message.tasks:
            if task.name == "end_effector":
                self.error = task.error_norm
                self.reference = np.array(task.reference)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "reachable_targets":
                self.diagnostics = {pair.key: pair.value for pair in status.values}

    def until(self, condition: Callable[[], Any], what: str) -> None:
        deadline = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < deadline, what
            self._executor.spin_once(timeout_sec=0.05)


@pytest.fixture
def operator(ros_context: Any) -> Any:
    operator = Operator(ros_context)
    yield operator
    operator.node.destroy_node()


def test_a_stream_moves_the_robot_to_its_target(operator: Operator, start_node: Any) -> None:
    """KUKA in lockstep, poses at 50 Hz of its time; bad ones and a forged state change nothing."""
    arguments = ("--ros-args", "-p", "robot:=kuka_lwr")
    targets = start_node("ghc_controller", "reachable_targets", *arguments)
    controller = start_node("ghc_controller", "controller", *arguments)
    targets.wait_for_output("ready", DEADLINE)
    controller.wait_for_output("ready", DEADLINE)
    operator.until(lambda: operator.poses.get_subscription_count() > 0, "no subscription")
    bridge = start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *ARM)
    operator.until(lambda: operator.now > 0, "no joint state")
    operator.sends = True
    operator.until(lambda: len(operator.references) > 5, "no reference")
    operator.until(lambda: operator.points.get_subscription_count() > 0, "no subscription")
    operator.poses.publish(operator.pose(np.array([np.nan, 0.0, 0.0])))
    operator.poses.publish(operator.pose(GOAL, "tool"))
    operator.points.publish(PointStamped(header=operator.pose(GOAL, "camera").header))
    for name, count in (
        ("rejected_targets/end_effector", 2),
        ("rejected_target_points/end_effector", 1),
    ):
        operator.until(
            lambda: int(operator.diagnostics.get(name, 0)) >= count,  # noqa: B023
            f"{name} not counted",
        )
    stamp = "rejected_joint_states.stamp"
    operator.forge_states_until(lambda: stamp in operator.diagnostics, "forged state not counted")
    operator.goal = GOAL + np.array([0.0, -0.1, 0.0])  # states after the forged one count
    operator.until(
        lambda: np.abs(operator.reference - operator.goal).max() < 1e-4 and operator.error < 1e-3,
        "the robot did not come to the target",
    )
    first = operator.references[0]
    assert len(first.points) >= 3
    assert all(len(point.velocity) == len(point.acceleration) == 3 for point in first.points)
    assert "frame_id 'camera' given, 'world' or an empty one expected" in targets.output
    bridge.send(signal.SIGINT)
    assert targets.stop() == 0
    assert controller.stop() == 0


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        (("robot:=kuka_lwr", "tasks:=[hand]"), "unknown task 'hand'; known: end_effector"),
        (
            ("robot:=kuka_lwr", "tasks:=[posture]"),
            "a task of a position, an orientation or a pose",
        ),
        (("robot:=kuka_lwr", "stamps:=wall"), "'wall' given; known: header, arrival"),
        (("robot:=kuka_lwr", "velocity_share:=2.0"), "in (0, 1] expected, 2.0 given"),
        (("robot:=kuka_lwr", "period:=0.0001"), "in [0.005, 0.05] expected"),
    ],
)
def test_parameters_that_cannot_be_used_are_refused(
    start_node: Any, parameters: tuple[str, ...], reason: str
) -> None:
    words = [word for value in parameters for word in ("-p", value)]
    node = start_node("ghc_controller", "reachable_targets", "--ros-args", *words)
    assert node.wait(DEADLINE) == 2
    assert reason in node.output

"""Killing the controller in realtime: the bridge holds the arm, a restarted one takes over."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from ghc_msgs.msg import PriorityTransition, TransitionStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from ghc_controller.ros.qos import RELIABLE_QOS

RATE_LIMIT = 1000.0  # [Nm/s], at a control period of 1 ms: 1 Nm per period
CONTROL_DT = 1e-3  # [s]
HOLD = 1  # in the log: the bridge's own torque
CONTROLLER = f"--ros-args -p robot:=kuka_lwr -p torque_rate_limit:={RATE_LIMIT}"


class Client:
    """Watches the commands and asks for a transition."""

    def __init__(self, context: Any) -> None:
        self.node = Node("client", context=context)
        self.executor = SingleThreadedExecutor(context=context)
        self.executor.add_node(self.node)
        self.last_command = 0.0  # [s] wall
        self.accepted = False
        self.node.create_subscription(JointState, "joint_commands", self._on_command, 1)
        self.node.create_subscription(
            TransitionStatus, "ghc/transition_status", self._on_status, RELIABLE_QOS
        )
        self.request = self.node.create_publisher(
            PriorityTransition, "ghc/priority_transition", RELIABLE_QOS
        )

    def _on_command(self, _: JointState) -> None:
        self.last_command = time.monotonic()

    def _on_status(self, message: TransitionStatus) -> None:
        self.accepted |= message.status == TransitionStatus.ACCEPTED

    def spin(self, seconds: float) -> None:
        """Listen for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.05)

    def until(self, condition: Callable[[], bool]) -> None:
        """Listen until something is so."""
        deadline = time.monotonic() + 90.0
        while not condition():
            assert time.monotonic() < deadline
            self.executor.spin_once(timeout_sec=0.05)

    def wait_for_commands(self) -> None:
        """Listen until fresh commands flow."""
        begin = time.monotonic()
        self.until(lambda: self.last_command > begin)


def test_kill_and_take_over(
    ros_context: Any, start_node: Callable[..., Any], tmp_path: Path
) -> None:
    """No joint faster than 0.5 rad/s one second after the kill; no torque step above the limit."""
    log = tmp_path / "log.npz"
    bridge = start_node(
        "ghc_sim_bridge",
        "sim_bridge",
        *["--ros-args", "-p", "scene:=kuka_lwr", "-p", "mode:=realtime"],
        *f"-p torque_rate_limit:={RATE_LIMIT} -p log_file:={log}".split(),
    )
    controller = start_node("ghc_controller", "controller", *CONTROLLER.split())
    client = Client(ros_context)
    client.wait_for_commands()
    client.until(lambda: client.request.get_subscription_count() > 0)
    client.request.publish(
        PriorityTransition(hierarchy="posture > elbow > end_effector", duration=2.0)
    )
    client.until(lambda: client.accepted)
    client.spin(1.0)  # in the middle of the transition
    controller.send(signal.SIGKILL)
    controller.wait()
    client.spin(1.5)
    start_node("ghc_controller", "controller", *CONTROLLER.split())
    client.wait_for_commands()
    client.spin(1.5)
    assert bridge.stop() == 0

    data = np.load(log)
    held = data["source"] == HOLD
    # the long hold is the one after the kill; before the first command there is another one
    starts = np.flatnonzero(np.diff(np.concatenate([[0], held.view(np.int8), [0]])) == 1)
    ends = np.flatnonzero(np.diff(np.concatenate([[0], held.view(np.int8), [0]])) == -1)
    later = starts > np.flatnonzero(~held)[0]
    longest = np.argmax((ends - starts) * later)
    begin, end = starts[longest], ends[longest]
    assert (end - begin) * CONTROL_DT > 1.2
    assert end < len(held)  # a controller took over again
    settled = begin + round(1.0 / CONTROL_DT)
    assert np.abs(data["v"][settled:end]).max() < 0.5
    steps = np.abs(np.diff(data["torque"], axis=0))
    assert steps.max() <= RATE_LIMIT * CONTROL_DT * (1.0 + 1e-9)

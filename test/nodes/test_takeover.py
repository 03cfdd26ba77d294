"""Killing the controller in realtime: the bridge holds the arm, a restarted one takes over."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from bridge_client import BridgeClient
from ghc_msgs.msg import PriorityTransition, TransitionStatus

from ghc_controller.ros.qos import RELIABLE_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS

RATE_LIMIT = 1000.0  # [Nm/s], at a control period of 1 ms: 1 Nm per period
CONTROL_DT = 1e-3  # [s]
HOLD = 1  # in the log: the bridge's own torque
CONTROLLER = f"--ros-args -p robot:=kuka_lwr -p torque_rate_limit:={RATE_LIMIT}"


class Client(BridgeClient):
    """Watches the robot and asks for a transition."""

    def __init__(self, context: Any) -> None:
        super().__init__(context)
        self.accepted = False
        self.node.create_subscription(
            TransitionStatus, "ghc/transition_status", self._on_status, RELIABLE_QOS
        )
        self.request = self.node.create_publisher(
            PriorityTransition, "ghc/priority_transition", RELIABLE_QOS
        )

    def _on_status(self, message: TransitionStatus) -> None:
        self.accepted |= message.status == TransitionStatus.ACCEPTED

    def ask(self) -> None:
        """Send the transition."""
        self.request.publish(
            PriorityTransition(hierarchy="posture > elbow > end_effector", duration=2.0)
        )

    def pass_time(self, seconds: float) -> None:
        """Listen until `seconds` [s] of simulated time have passed."""
        end = self._now() + seconds
        self.until(lambda: self._now() > end, f"{seconds:g} s of simulated time")

    def _now(self) -> float:
        return nanoseconds_from_time(self.next_state().header.stamp) / NANOSECONDS

    def until_held(self, held: bool) -> None:
        """Listen until the bridge holds the robot, or a controller drives it."""
        self.until(lambda: self.diagnostics.get("holding") == str(held), f"holding: {held}")


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
    client.until_held(False)
    client.until(lambda: client.request.get_subscription_count() > 0, "the controller")
    client.ask()
    client.until(lambda: client.accepted, "an answer", again=client.ask)
    client.pass_time(1.0)  # in the middle of the transition
    controller.send(signal.SIGKILL)
    controller.wait()
    client.pass_time(1.5)
    client.until_held(True)
    start_node("ghc_controller", "controller", *CONTROLLER.split())
    client.until_held(False)
    client.pass_time(1.5)
    assert bridge.stop() == 0
    client.close()

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

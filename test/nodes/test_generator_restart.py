"""Killing the force bound generator while bounds move: the plan is followed, said so, resumed."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import ContactSchedule, ControllerState
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.ros.qos import SCHEDULE_QOS, STREAM_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_mpc_constraints.ros.conversions import schedule_message
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule as Schedule

DEADLINE = 90.0  # [s] wall, for anything that must happen
RATE_LIMIT = 1000.0  # [Nm/s], at a control period of 1 ms: 1 Nm per period
HIGH, LOW = 60.0, 20.0  # [N]
FASTEST = (HIGH - LOW) / 5.0 * 15.6  # [N/s] of the smoothed bound, linear in the step (fig. 5.10)
HORIZON = 1.5  # [s]


class Client:
    """Publishes schedules, remembers the upper bound in force and what the diagnostics say."""

    def __init__(self, context: Any) -> None:
        self.node = Node("client", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.bounds: list[tuple[float, float]] = []  # time [s], upper [N]
        self.summary = ""
        self._schedules = self.node.create_publisher(
            ContactSchedule, "constraints/contact_schedule", SCHEDULE_QOS
        )
        listen = self.node.create_subscription
        listen(ControllerState, "ghc/controller_state", self._on_state, STREAM_QOS)
        listen(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)

    def _on_state(self, message: ControllerState) -> None:
        if message.contacts and message.contacts[0].planned:
            stamp = nanoseconds_from_time(message.header.stamp) * 1e-9
            self.bounds.append((stamp, message.contacts[0].upper))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "controller":
                self.summary = status.message

    def until(self, condition: Callable[[], bool]) -> None:
        """Listen until something is so."""
        deadline = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < deadline, self.summary
            self._executor.spin_once(timeout_sec=0.05)

    def schedule(self, times: list[float], upper: list[float]) -> None:
        """Ask for upper bounds from these simulated times [s] on."""
        lower = [0.0] * len(times)
        self._schedules.publish(
            schedule_message(Schedule.checked("tool", times, lower, upper, []))
        )


@pytest.fixture
def robot_file(tmp_path: Path) -> Path:
    """The arm with a contact at its tool that is always on; its hierarchy leaves it free."""
    source = load_robot_config(find_robot("kuka_lwr"))
    values = yaml.safe_load(source.path.read_text(encoding="utf-8"))
    values["urdf"] = str(source.urdf)
    contact = {"name": "tool", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]}
    values["contacts"] = [contact | {"active": True, "friction": 0.5}]
    path = tmp_path / "robot.yaml"
    path.write_text(yaml.safe_dump(values), encoding="utf-8")
    return path


def test_a_killed_generator_leaves_a_safe_bound_and_a_new_one_goes_on_from_it(
    ros_context: Any, start_node: Callable[..., Any], tmp_path: Path, robot_file: Path
) -> None:
    log = tmp_path / "log.npz"
    arguments = f"-p mode:=realtime -p torque_rate_limit:={RATE_LIMIT} -p log_file:={log}"
    bridge = start_node(
        *("ghc_sim_bridge", "sim_bridge", "--ros-args", "-p", "scene:=kuka_lwr"),
        *arguments.split(),
    )
    start_node(
        *("ghc_controller", "controller", "--ros-args", "-p", f"robot:={robot_file}"),
        *f"-p torque_rate_limit:={RATE_LIMIT} -p state_rate:=200.0".split(),
    )
    generator = start_node("ghc_mpc_constraints", "contact_force_bounds")
    client = Client(ros_context)
    client.schedule([0.0], [HIGH])
    client.until(lambda: bool(client.bounds) and client.bounds[-1][1] == HIGH)
    drop = client.bounds[-1][0] + 2.0 * HORIZON  # known long before
    client.schedule([0.0, drop], [HIGH, LOW])
    client.until(lambda: client.bounds[-1][1] < HIGH - 5.0)
    killed_at = client.bounds[-1][0]
    generator.send(signal.SIGKILL)
    generator.wait()
    client.until(lambda: "contact_forces: last one" in client.summary)
    restarted = start_node("ghc_mpc_constraints", "contact_force_bounds")
    client.until(lambda: "contact_forces" not in client.summary)
    again = client.bounds[-1][0] + 1.0
    client.schedule([0.0, drop, again], [HIGH, LOW, HIGH])
    client.until(lambda: client.bounds[-1][1] > HIGH - 1.0)
    assert restarted.stop() == 0
    assert bridge.stop() == 0

    times, upper = np.array(client.bounds).T
    rates = np.abs(np.diff(upper) / np.maximum(np.diff(times), 5e-3))
    assert rates[10:].max() < 1.2 * FASTEST  # no jump: not at the kill, nor at the restart
    raw = np.where(times < drop, HIGH, np.where(times < again, LOW, HIGH))
    assert (upper <= raw + 1e-3).all()
    assert killed_at < drop
    data = np.load(log)
    steps = np.abs(np.diff(data["torque"], axis=0))
    assert steps.max() <= RATE_LIMIT * 1e-3 * (1.0 + 1e-9)

"""A robot behind ros2_control as a process: the doubles around the simulator, by the wall clock.

`effort_robot.py --log FILE [--rate HZ] [--watchdog SECONDS] [--joints a,b,...] [--no-effort]`

Publishes joint_states, subscribes /effort_controller/commands and, with a watchdog,
joint_commands: the only topic that says which state a torque answers. The hardware keeps its
brakes on until every joint has a finite command, and clips to its torque limits.
"""

from __future__ import annotations

import argparse
import signal
import time
from pathlib import Path

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_system_default
from rclpy.signals import SignalHandlerOptions
from ros2_control_doubles import (
    EffortInterfaces,
    JointGroupEffortController,
    JointStateBroadcaster,
)
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_sim_bridge.bridge.realtime import Pacer, Watchdog
from ghc_sim_bridge.simulation.simulator import Simulator

SCENE = "kuka_lwr"


class EffortRobot:
    """read, update, write: one cycle of the controller manager ([L] 121-123 in the doubles)."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.node = Node("controller_manager")
        self._period = 1.0 / options.rate
        self._simulator = Simulator(SCENE, control_dt=self._period)
        names = self._simulator.joint_names
        self._interfaces = EffortInterfaces(names)
        self._effort = JointGroupEffortController(
            options.joints.split(",") if options.joints else names, self._interfaces
        )
        self._broadcaster = JointStateBroadcaster(names, options.frame)
        self._fields = ("position", "velocity", "" if options.no_effort else "effort")
        self._watchdog = Watchdog(round(options.watchdog * 1e9)) if options.watchdog else None
        self._pacer = Pacer(self._period, time.monotonic())
        self._rows: list[tuple[float, ...]] = []
        self._log: Path = options.log
        # SystemDefaultsQoS on both sides ([F] 60, [B] 147 in the doubles).
        self._states = self.node.create_publisher(
            JointState, "joint_states", qos_profile_system_default
        )
        self.node.create_subscription(
            Float64MultiArray,
            "/effort_controller/commands",
            lambda message: self._effort.on_command(message.data),
            qos_profile_system_default,
        )
        self.node.create_subscription(
            JointState, "joint_commands", self._on_stamp, CONTROL_SUBSCRIBER_QOS
        )
        if not self._effort.activate():
            raise SystemExit(f"no such joints: {options.joints}; there are {', '.join(names)}")

    def _on_stamp(self, message: JointState) -> None:
        stamp_ns = nanoseconds_from_time(message.header.stamp)
        if self._watchdog is not None and not self._watchdog.refuses(stamp_ns, time.time_ns()):
            self._watchdog.accept(stamp_ns)

    def cycle(self) -> None:
        """Do what is due by the wall clock."""
        due = self._pacer.due(time.monotonic())
        if not due:
            return
        state, now_ns = self._simulator.state(), time.time_ns()
        values = zip(state.q, state.v, self._simulator.torque, strict=True)
        interfaces = {
            name: dict(zip(self._fields, map(float, three), strict=True))
            for name, three in zip(self._simulator.joint_names, values, strict=True)
        }
        self._states.publish(self._broadcaster.message(now_ns, interfaces))
        self._effort.update()
        self._write(due, now_ns)

    def _write(self, periods: int, now_ns: int) -> None:
        held = self._watchdog is not None and self._watchdog.check(now_ns)
        braked = not self._interfaces.complete
        simulator = self._simulator
        for _ in range(0 if braked else periods):
            commanded = np.array([self._interfaces.values[n] for n in simulator.joint_names])
            wanted = simulator.hold_torque() if held else commanded
            simulator.step(np.clip(wanted, -simulator.torque_limit, simulator.torque_limit))
        source = 2.0 if braked else float(held)
        state = simulator.state()
        self._rows.append((now_ns * 1e-9, source, *state.q, *state.v, *simulator.torque))

    def close(self) -> None:
        """Write what happened: a row per cycle."""
        rows, n = np.array(self._rows), len(self._simulator.joint_names)
        q, v, torque = np.split(rows[:, 2:], [n, 2 * n], axis=1)
        np.savez(
            self._log, time=rows[:, 0], source=rows[:, 1], q=q, v=v, torque=torque,
            dropped=self._effort.dropped, wrong_size=self._effort.wrong_size,
        )  # fmt: skip


def main() -> None:
    """Run until a signal."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--log", type=Path, required=True)
    parser.add_argument("--rate", type=float, default=200.0, help="[Hz]")
    parser.add_argument("--watchdog", type=float, default=0.0, help="[s], 0 = none")
    parser.add_argument("--joints", default="", help="order of the effort controller")
    parser.add_argument("--no-effort", action="store_true", help="no effort state interface")
    parser.add_argument("--frame", default="", help="frame_id of the joint states")
    options = parser.parse_args()
    stopped: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda given, _frame: stopped.append(given))
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    robot = EffortRobot(options)
    executor = SingleThreadedExecutor()
    executor.add_node(robot.node)
    while not stopped:
        executor.spin_once(timeout_sec=0.0005)
        robot.cycle()
    robot.close()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()

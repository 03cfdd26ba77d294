"""The bridge's partner in tests: a client in this process, or a controller in one of its own."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import Epoch
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

from ghc_controller.robot.library import find_robot
from ghc_controller.ros.qos import (
    CONTROL_PUBLISHER_QOS,
    CONTROL_SUBSCRIBER_QOS,
    LATCHED_QOS,
)
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.ros.wire.epochs import EPOCH_TOPIC

ROBOT = "kuka_lwr"
DEADLINE = 90.0  # [s] wall
EXIT = 60.0  # [s] wall, for a node that ends by itself soon after its start


class GravityModel:
    """Torques of the robot model, which the simulator does not see."""

    def __init__(self) -> None:
        self._model = pin.buildModelFromUrdf(str(find_robot(ROBOT).with_name(f"{ROBOT}.urdf")))
        self._data = self._model.createData()

    def hold(self, state: JointState) -> np.ndarray:
        """Gravity compensation (7,) [Nm]."""
        return np.array(
            pin.computeGeneralizedGravity(self._model, self._data, np.array(state.position))
        )

    def swing(self, state: JointState) -> np.ndarray:
        """Gravity and bias compensation, and an acceleration that goes to and fro (7,) [Nm]."""
        q, v = np.array(state.position), np.array(state.velocity)
        now = nanoseconds_from_time(state.header.stamp) * 1e-9
        wanted = 2.0 * np.cos(4.0 * now) * np.array([1.0, -0.5, 0.3, 0.5, 1.0, 0.5, 1.0])
        return np.array(pin.rnea(self._model, self._data, q, v, wanted))


def answer(state: JointState, torque: Sequence[float]) -> JointState:
    """Command for `state`."""
    command = JointState(name=state.name, effort=[float(value) for value in torque])
    command.header.stamp = time_from_nanoseconds(nanoseconds_from_time(state.header.stamp))
    return command


class BridgeClient:
    """Reads joint states, answers them when told to, and calls the services."""

    def __init__(self, context: rclpy.Context) -> None:
        self.node = Node("client", context=context)
        self.states: list[JointState] = []
        self.epochs: list[Epoch] = []
        self.diagnostics: dict[str, str] = {}
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.commands = self.node.create_publisher(
            JointState, "joint_commands", CONTROL_PUBLISHER_QOS
        )
        self.node.create_subscription(
            JointState, "joint_states", self.states.append, CONTROL_SUBSCRIBER_QOS
        )
        self.node.create_subscription(Epoch, EPOCH_TOPIC, self.epochs.append, LATCHED_QOS)
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "sim_bridge":
                self.diagnostics = {pair.key: pair.value for pair in status.values}

    def until(
        self,
        condition: Callable[[], Any],
        what: str,
        timeout: float = DEADLINE,
        again: Callable[[], Any] | None = None,
    ) -> None:
        """Spin until `condition`, doing `again` once a second; fail after `timeout` [s].

        A message to a node that has not heard of its sender yet is lost, also over a reliable
        connection: what has to arrive is sent by `again`.
        """
        start = time.monotonic()
        due = start + 1.0
        while not condition():
            self._executor.spin_once(timeout_sec=0.05)
            now = time.monotonic()
            assert now < start + timeout, f"{what} did not come within {timeout:g} s"
            if again is not None and now > due:
                again()
                due = now + 1.0

    def spin(self, seconds: float) -> None:
        """Spin for `seconds` [s] of wall time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    def alone(self) -> None:
        """Listen until no state has come for half a second: what a bridge sent before its end."""
        quiet = 0
        while quiet < 10:
            self.states.clear()
            self.spin(0.05)
            quiet = 0 if self.states else quiet + 1

    def next_state(self) -> JointState:
        """The next joint state that arrives."""
        self.states.clear()
        self.until(lambda: self.states, "a joint state")
        return self.states[-1]

    def step(self, state: JointState, torque: Sequence[float]) -> JointState:
        """Answer `state` and wait for the one that follows."""
        command = answer(state, torque)
        self.commands.publish(command)
        stamp = nanoseconds_from_time(state.header.stamp)
        self.states.clear()
        self.until(
            lambda: any(nanoseconds_from_time(s.header.stamp) > stamp for s in self.states),
            f"the state after {stamp} ns",
            again=lambda: self.commands.publish(command),
        )
        return self.states[-1]

    def connected_state(self) -> JointState:
        """A state of a bridge that can hear this client."""
        self.until(lambda: self.commands.get_subscription_count() > 0, "the bridge's subscription")
        return self.next_state()

    def counted(self, key: str, at_least: int, again: Callable[[], Any] | None = None) -> None:
        """Wait until the diagnostics show that many events, doing `again` once a second."""
        self.until(
            lambda: int(self.diagnostics.get(f"rejected_{key}", "0")) >= at_least,
            f"rejected_{key} >= {at_least} in the diagnostics",
            again=again,
        )

    def reset(self) -> str:
        """Call ~/reset; its answer."""
        return str(self._call(Trigger, "sim_bridge/reset", Trigger.Request()))

    def pause(self, paused: bool) -> str:
        """Call ~/pause; its answer."""
        return str(self._call(SetBool, "sim_bridge/pause", SetBool.Request(data=paused)))

    def _call(self, kind: Any, name: str, request: Any) -> str:
        client = self.node.create_client(kind, name)
        self.until(client.service_is_ready, name)
        future = client.call_async(request)
        self.until(future.done, f"the answer of {name}")
        assert future.result().success
        return str(future.result().message)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self.node.destroy_node()


def main() -> None:
    """A controller as a process: `bridge_client.py hold|swing`."""
    stopped: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda given, _frame: stopped.append(given))
    rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    node = Node("test_controller")
    torque = getattr(GravityModel(), sys.argv[1])
    commands = node.create_publisher(JointState, "joint_commands", CONTROL_PUBLISHER_QOS)
    node.create_subscription(
        JointState,
        "joint_states",
        lambda state: commands.publish(answer(state, torque(state))),
        CONTROL_SUBSCRIBER_QOS,
    )
    executor = rclpy.experimental.events_executor.EventsExecutor()
    executor.add_node(node)
    while not stopped:
        executor.spin_once(timeout_sec=0.1)


if __name__ == "__main__":
    import rclpy.experimental.events_executor
    import rclpy.signals

    main()

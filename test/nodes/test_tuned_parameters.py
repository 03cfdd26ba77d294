"""Parameters of the controller node that change while it runs, as `ros2 param set` does."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from ghc_controller.ros.by_hand.tune import main as tune

WAIT = 90.0  # [s] wall
ARM = ("-p", "scene:=kuka_lwr", "-p", f"lockstep_timeout:={WAIT}")


class Client:
    """Sets and reads parameters of the node `controller`."""

    def __init__(self, node: Node, context: Context) -> None:
        self._node = node
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(node)

    def call(self, kind: Any, service: str, request: Any) -> Any:
        client = self._node.create_client(kind, f"/controller/{service}")
        assert client.wait_for_service(WAIT)
        future = client.call_async(request)
        self._executor.spin_until_future_complete(future, WAIT)
        return future.result()

    def set(self, name: str, value: Any) -> str:
        """Reason of a refusal; empty where the value was taken."""
        parameter = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[parameter])
        result = self.call(SetParameters, "set_parameters", request).results[0]
        assert result.successful == (result.reason == "")
        return str(result.reason)

    def get(self, name: str) -> Any:
        request = GetParameters.Request(names=[name])
        value = self.call(GetParameters, "get_parameters", request).values[0]
        return rclpy.parameter.parameter_value_to_python(value)

    def describe(self, name: str) -> ParameterDescriptor:
        request = DescribeParameters.Request(names=[name])
        return self.call(DescribeParameters, "describe_parameters", request).descriptors[0]


def test_what_can_change_changes_and_the_rest_is_refused_with_a_reason(
    start_node: Callable[..., Any], ros_context: Context, capsys: pytest.CaptureFixture[str]
) -> None:
    start_node("ghc_sim_bridge", "sim_bridge", "--ros-args", *ARM)
    controller = start_node("ghc_controller", "controller", "--ros-args", "-p", "robot:=kuka_lwr")
    client = Client(rclpy.create_node("tuner", context=ros_context), ros_context)

    gain = client.describe("tasks.elbow.stiffness")
    assert gain.description.startswith("[1/s^2]")
    assert gain.floating_point_range[0].from_value == 0.0
    assert not gain.read_only
    assert client.describe("control_dt").read_only
    stiffness = client.get("tasks.elbow.stiffness")
    assert len(stiffness) == 3

    assert client.set("tasks.elbow.stiffness", 2.0 * stiffness[0]) == ""
    assert client.set("tasks.elbow.damping", [20.0, 20.0, 16.0]) == ""
    assert client.set("tasks.elbow.damping", [20.0, 20.0]).endswith("one number or 3 expected")
    assert "numbers >= 0 expected" in client.set("tasks.elbow.damping", "fast")
    assert client.set("regularization", 1) == "", "a whole number is as good"
    assert "above 0" in client.set("regularization", 0)
    assert client.get("regularization") == 1
    assert client.set("obstacle_horizon", 1e200) == "", "its square is no number"
    assert "it is off since the start" in client.set("torque_bound", 50.0)
    assert "read-only" in client.set("control_dt", 0.002)

    assert client.set("tuning_duration", 0.05) == ""
    assert client.set("formulation", "balanced") == ""
    deadline = time.monotonic() + WAIT
    while (reason := client.set("formulation", "cascade")) and time.monotonic() < deadline:
        assert "formulation" in reason
        time.sleep(0.05)
    assert reason == ""
    assert "known" in client.set("formulation", "cascad")
    assert controller.exit_code is None

    assert tune(["velocity_damping", "10", "velocity_limit", "0.5"]) == 0
    assert tune(["velocity_damping", "15", "velocity_limit", "-1"]) == 1
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "SET velocity_damping 10, velocity_limit 0.5"
    assert said[1].startswith("REJECTED")
    assert "velocity_limit" in said[1]
    assert client.get("velocity_damping") == 10

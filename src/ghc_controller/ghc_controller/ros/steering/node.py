"""Targets, hierarchy and gains by sliders in the browser: `ros2 run ghc_controller steer`.

Publishes   targets/<task> (for reachable_targets), ghc/priority_transition.
Subscribes  ghc/controller_state, ghc/priority_matrix, ghc/transition_status,
            ghc/task_reference_status.
Calls       controller/get_parameters, controller/set_parameters_atomically.
Parameters  see SteeringParameters.
"""

from __future__ import annotations

import sys
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from ghc_msgs.msg import (
    ControllerState,
    PriorityMatrix,
    PriorityTransition,
    TaskReferenceStatus,
    TransitionStatus,
)
from rcl_interfaces.srv import GetParameters, SetParametersAtomically
from rclpy.client import Client
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.publisher import Publisher
from rclpy.task import Future

from ghc_controller.errors import ConfigurationError, InvalidValue, UnknownName
from ghc_controller.references.follower import Follower, ReferenceSpace
from ghc_controller.robot.library import load_robot
from ghc_controller.ros.node_parameters import read_parameters
from ghc_controller.ros.qos import LATCHED_QOS, RELIABLE_QOS, STREAM_QOS
from ghc_controller.ros.run import run_node
from ghc_controller.ros.steering.page_server import PageServer
from ghc_controller.ros.steering.parameters import SteeringParameters
from ghc_controller.ros.time import seconds_from_time
from ghc_controller.ros.transition import status_line
from ghc_controller.tasks.task import Task

NODE_NAME = "steering_page"
SERVICE = "controller/set_parameters_atomically"
GAINS_SERVICE = "controller/get_parameters"
_ANSWER = 5.0  # [s] wall
_NEWS = 50
_POSITION = ["x", "y", "z"]


class SteeringPage:
    """Actions of the page, as messages; nothing is sent that the page did not ask for."""

    def __init__(self, stop: Future) -> None:  # noqa: ARG002  ends by signals only
        """Listen for the controller, serve the page.

        Raises:
            GhcError: a parameter or the robot's file cannot be used.
        """
        node = self.node = Node(NODE_NAME, automatically_declare_parameters_from_overrides=True)
        p = read_parameters(node, SteeringParameters)
        self.executor = p.executor
        self._tasks = {task.name: task for task in load_robot(p.robot).tasks}
        self._state: ControllerState | None = None
        self._hierarchy = ""
        self._news: deque[str] = deque(maxlen=_NEWS)
        self._targets = {
            name: node.create_publisher(PoseStamped, f"targets/{name}", RELIABLE_QOS)
            for name, task in self._tasks.items()
            if _has_position(task)
        }
        self._transitions = node.create_publisher(
            PriorityTransition, "ghc/priority_transition", RELIABLE_QOS
        )
        self._gains = node.create_client(SetParametersAtomically, SERVICE)
        self._present_gains = node.create_client(GetParameters, GAINS_SERVICE)
        self._gain_names = [
            f"tasks.{name}.{gain}" for name in self._tasks for gain in ("stiffness", "damping")
        ]
        self._listen()
        actions = {
            "state": self.state,
            "target": self.send_target,
            "hierarchy": self.send_hierarchy,
            "gain": self.send_gain,
        }
        self._page = PageServer(actions, p.port)
        node.get_logger().info(f"open {self._page.address}")

    def _listen(self) -> None:
        node = self.node
        node.create_subscription(
            ControllerState, "ghc/controller_state", self._on_state, STREAM_QOS
        )
        node.create_subscription(
            PriorityMatrix, "ghc/priority_matrix", self._on_matrix, LATCHED_QOS
        )
        node.create_subscription(
            TransitionStatus,
            "ghc/transition_status",
            lambda message: self._news.append(status_line(message).split("s  ", 1)[1]),
            RELIABLE_QOS,
        )
        node.create_subscription(
            TaskReferenceStatus, "ghc/task_reference_status", self._on_reference, RELIABLE_QOS
        )

    def _on_state(self, message: ControllerState) -> None:
        self._state = message

    def _on_matrix(self, message: PriorityMatrix) -> None:
        self._hierarchy = message.hierarchy

    def _on_reference(self, message: TaskReferenceStatus) -> None:
        if message.status == TaskReferenceStatus.REJECTED:
            self._news.append(f"REJECTED {message.task}: {message.reason}")

    def state(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """What the page shows; InvalidValue before the first report of the controller.

        With the field `gains`, those of the running controller; none until it has told them.
        """
        report = self._state
        if report is None:
            raise InvalidValue("no ghc/controller_state came yet: is the controller running?")
        news = [self._news.popleft() for _ in range(len(self._news))]
        return {
            "time": seconds_from_time(report.header.stamp),
            "hierarchy": self._hierarchy,
            "tasks": [{"name": t.name, "error": t.error_norm} for t in report.tasks],
            "targets": [
                {"name": t.name, "position": [float(x) for x in t.reference[:3]]}
                for t in report.tasks
                if t.name in self._targets
                and len(t.reference) >= 3
                and np.isfinite(t.reference[:3]).all()
            ],
            "gains": self._read_gains() if fields.get("gains") else {},
            "news": news,
        }

    def _read_gains(self) -> dict[str, float]:
        """Gain -> its value, the mean where rows differ; empty without an answer."""
        if not self._present_gains.service_is_ready():
            return {}
        request = GetParameters.Request(names=self._gain_names)
        response = ask(self._present_gains, request)
        values = [] if response is None else map(parameter_value_to_python, response.values)
        return {
            name: float(np.mean(value))
            for name, value in zip(self._gain_names, values, strict=False)
            if value is not None
        }

    def send_target(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """One sample of the target of a task, to reachable_targets."""
        name, position = str(fields["task"]), [float(value) for value in fields["position"]]
        if name not in self._targets:
            raise UnknownName("task with a position", name, self._targets)
        if len(position) != len(_POSITION) or not np.isfinite(position).all():
            raise InvalidValue(f"position: {position} given, three finite numbers expected")
        publisher: Publisher = self._targets[name]
        if publisher.get_subscription_count() == 0:
            raise ConfigurationError(
                f"nobody reads targets/{name}; start `ros2 run ghc_controller reachable_targets "
                f'--ros-args -p robot:=... -p tasks:="[{name}]"`'
            )
        message = PoseStamped()
        point, turn = message.pose.position, message.pose.orientation
        point.x, point.y, point.z = position
        turn.x, turn.y, turn.z, turn.w = orientation_kept(self._tasks[name], self._state)
        publisher.publish(message)
        return {"text": f"{name} to {position}"}

    def send_hierarchy(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """A transition; its status comes as news."""
        if self._transitions.get_subscription_count() == 0:
            raise ConfigurationError("nobody reads ghc/priority_transition: no controller")
        request = PriorityTransition(
            id=NODE_NAME, hierarchy=str(fields["hierarchy"]), duration=float(fields["duration"])
        )
        self._transitions.publish(request)
        return {"text": f"sent {request.hierarchy}"}

    def send_gain(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        """A gain for all rows of a task, by the controller's blend."""
        name, value = str(fields["name"]), float(fields["value"])
        if not self._gains.service_is_ready():
            raise ConfigurationError(f"no {SERVICE}: no controller")
        parameter_message = Parameter(name, value=value).to_parameter_msg()
        request = SetParametersAtomically.Request(parameters=[parameter_message])
        response = ask(self._gains, request)
        if response is None:
            raise InvalidValue(f"no answer of the controller within {_ANSWER:g} s")
        if not response.result.successful:
            raise InvalidValue(response.result.reason)
        return {"text": f"SET {name} {value:g}"}

    def close(self) -> None:
        """Stop serving."""
        self._page.close()


def orientation_kept(task: Follower, report: ControllerState | None) -> list[float]:
    """(x, y, z, w) of the present reference of a pose, any of a position.

    Raises:
        InvalidValue: the controller reports none, and another orientation would turn the frame.
    """
    if task.space is ReferenceSpace.VECTOR:
        return [0.0, 0.0, 0.0, 1.0]
    for one in () if report is None else report.tasks:
        if one.name == task.name and len(one.reference) == task.position_size:
            return [float(value) for value in one.reference[-4:]]
    raise InvalidValue(f"task '{task.name}': its orientation is not reported by the controller")


def ask(client: Client, request: Any, within: float = _ANSWER) -> Any:
    """Response of a service, None without one in time [s]; for threads that do not spin.

    A request that is not answered in time is forgotten: the client would keep it for ever.
    """
    answered = threading.Event()
    future = client.call_async(request)
    future.add_done_callback(lambda _: answered.set())
    if answered.wait(within):
        return future.result()
    client.remove_pending_request(future)
    return None


def _has_position(task: Task) -> bool:
    """Whether targets of a task begin with x, y and z in the world."""
    if task.space is ReferenceSpace.VECTOR:
        return list(task.labels) == _POSITION
    return task.space is ReferenceSpace.POSE


def main(args: Sequence[str] | None = None) -> int:
    """Serve until a signal; exit code 0, 1 (failed while running) or 2 (rejected)."""
    return run_node(NODE_NAME, SteeringPage, args)


if __name__ == "__main__":
    sys.exit(main())

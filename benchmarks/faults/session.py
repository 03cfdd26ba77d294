"""Nodes under test in a ROS domain of their own, and a client that moves the robot and injects."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Self

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from ghc_msgs.msg import (
    ControllerMode,
    ControllerState,
    Epoch,
    ObstacleStateArray,
    PriorityMatrix,
    PriorityTransition,
    TaskReference,
    TaskReferencePoint,
    Tick,
    TransitionStatus,
)
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from benchmarks.faults.monitor import READY
from ghc_controller.ros.qos import (
    CONTROL_PUBLISHER_QOS,
    CONTROL_SUBSCRIBER_QOS,
    LATCHED_QOS,
    RELIABLE_QOS,
    STREAM_QOS,
)
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds
from ghc_controller.types import NANOSECONDS
from ghc_sim_bridge.run.domain import DomainLock
from ghc_sim_bridge.run.executables import find_executable
from ghc_sim_bridge.run.processes import NodeProcess

JOINTS = tuple(f"joint_{i}" for i in range(1, 8))
SCENE = ROBOT = "kuka_lwr"
PATIENCE = 60.0  # [s] wall, for what must happen
NODES = {
    "sim_bridge": ("ghc_sim_bridge", "sim_bridge"),
    "controller": ("ghc_controller", "controller"),
    "obstacle_bounds": ("ghc_mpc_constraints", "obstacle_bounds"),
    "contact_force_bounds": ("ghc_mpc_constraints", "contact_force_bounds"),
    "recorder": ("ghc_sim_bridge", "recorder"),
}
# Targets [m] between which the arm is sent to and fro, fast.
TARGETS = ((0.45, 0.30, 0.65), (0.45, -0.30, 0.55))


class Session:
    """Bridge, controller and monitor as processes; leaving the context ends them all."""

    def __init__(self, folder: Path, control_dt: float = 2e-3) -> None:
        """Logs and recordings go to `folder`; `control_dt` [s] of bridge and controller."""
        self.folder = folder
        self.control_dt = control_dt
        folder.mkdir(parents=True, exist_ok=True)
        self._lock = DomainLock()
        self._environment = os.environ | {
            "ROS_DOMAIN_ID": str(self._lock.id),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(folder),
            "PYTHONPATH": os.pathsep.join(path or "." for path in sys.path),
        }
        self.processes: dict[str, NodeProcess] = {}
        self.defaults: dict[str, dict[str, object]] = {}  # executable -> parameters
        self._started = 0
        os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=self._lock.id)
        self.node = Node("fault_injector", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._create()

    def _create(self) -> None:
        create, listen = self.node.create_publisher, self.node.create_subscription
        self.states_out = create(JointState, "joint_states", CONTROL_PUBLISHER_QOS)
        self.commands_out = create(JointState, "joint_commands", CONTROL_PUBLISHER_QOS)
        self.transitions = create(PriorityTransition, "ghc/priority_transition", RELIABLE_QOS)
        self.references = create(TaskReference, "ghc/task_reference", RELIABLE_QOS)
        self.ticks = create(Tick, "ghc/tick", CONTROL_PUBLISHER_QOS)
        self.epochs = create(Epoch, "sim_bridge/epoch", LATCHED_QOS)
        self.obstacles = create(ObstacleStateArray, "constraints/obstacles", CONTROL_PUBLISHER_QOS)
        self.state: JointState | None = None  # the newest one of the bridge or anybody
        self.command: JointState | None = None
        self.report = ControllerState()
        self.statuses: list[TransitionStatus] = []
        self.diagnostics: dict[str, dict[str, str]] = {}
        self.mode = ControllerMode()
        self.matrices: list[PriorityMatrix] = []
        self.answered = 0  # commands heard
        listen(JointState, "joint_states", self._on_state, CONTROL_SUBSCRIBER_QOS)
        listen(JointState, "joint_commands", self._on_command, CONTROL_SUBSCRIBER_QOS)
        listen(ControllerState, "ghc/controller_state", self._on_report, STREAM_QOS)
        listen(TransitionStatus, "ghc/transition_status", self.statuses.append, RELIABLE_QOS)
        listen(ControllerMode, "ghc/controller_mode", self._on_mode, LATCHED_QOS)
        listen(PriorityMatrix, "ghc/priority_matrix", self.matrices.append, LATCHED_QOS)
        listen(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)

    def _on_state(self, message: JointState) -> None:
        if tuple(message.name) == JOINTS:  # ours name them in another order
            self.state = message

    def _on_command(self, message: JointState) -> None:
        if tuple(message.name) == JOINTS:
            self.command = message
            self.answered += 1

    def _on_mode(self, message: ControllerMode) -> None:
        self.mode = message

    def _on_report(self, message: ControllerState) -> None:
        self.report = message

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            values = {pair.key: pair.value for pair in status.values}
            self.diagnostics[status.name] = values | {"summary": status.message}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self.processes.values():
            process.send(signal.SIGCONT)
            process.send(signal.SIGINT)
        deadline = time.monotonic() + 10.0
        for process in self.processes.values():
            if not process.wait(deadline):
                process.send(signal.SIGKILL)
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)
        self._lock.release()

    def start(self, name: str, executable: str = "", **parameters: object) -> NodeProcess:
        """Start a node under the key `name`; bridge and controller in real time by default."""
        executable = executable or name
        defaults: Mapping[str, object] = {
            "sim_bridge": {"scene": SCENE, "mode": "realtime", "control_dt": self.control_dt},
            "controller": {"robot": ROBOT, "control_dt": self.control_dt},
        }.get(executable, {})
        values = {**defaults, **self.defaults.get(executable, {}), **parameters}
        arguments = [part for k, v in values.items() for part in ("-p", f"{k}:={v}")]
        command = [str(find_executable(*NODES[executable])), "--ros-args", *arguments]
        return self._run(name, command)

    def start_monitor(self) -> Path:
        """Start the monitor; the file that it will write."""
        path = self.folder / f"wire_{self._started}.npz"
        process = self._run("monitor", [sys.executable, "-m", "benchmarks.faults.monitor", path])
        self.until(lambda: READY in process.last_lines(), "the monitor")
        return path

    def kill(self, name: str) -> None:
        """End a node as a crash does."""
        process = self.processes.pop(name)
        process.send(signal.SIGKILL)
        process.wait(time.monotonic() + 5.0)

    def stop(self, name: str) -> int | None:
        """End a node in order; its exit code."""
        process = self.processes.pop(name)
        process.send(signal.SIGINT)
        process.wait(time.monotonic() + 20.0)
        return process.exit_code

    def _run(self, name: str, command: list[Any]) -> NodeProcess:
        log = self.folder / f"{name}_{self._started}.log"
        self._started += 1
        process = NodeProcess(name, [str(part) for part in command], log, self._environment)
        self.processes[name] = process
        return process

    def output(self, name: str) -> str:
        """All that a node printed."""
        return self.processes[name].last_lines(100000)

    def spin(self, seconds: float) -> None:
        """Listen for `seconds` [s] of wall time."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def until(self, condition: Callable[[], Any], what: str, timeout: float = PATIENCE) -> float:
        """Listen until `condition`; how long it took [s]. AssertionError after `timeout` [s]."""
        began = time.monotonic()
        while not condition():
            self._executor.spin_once(timeout_sec=0.005)
            if time.monotonic() - began > timeout:
                raise AssertionError(f"{what} did not come within {timeout:g} s")
        return time.monotonic() - began

    def ready(self) -> None:
        """Wait until states are answered and applied."""
        count = self.answered
        self.until(lambda: self.answered > count + 20, "answers of the controller")
        self.until(self.driving, "a robot that is driven")

    def driving(self) -> bool:
        """Whether the torque that the bridge applies is what was commanded last, or near it."""
        if self.state is None or self.command is None:
            return False
        age = nanoseconds_from_time(self.state.header.stamp) - nanoseconds_from_time(
            self.command.header.stamp
        )
        return abs(age) < 50_000_000

    def ask(self, hierarchy: str, duration: float = 0.5, **fields: Any) -> TransitionStatus:
        """Send a transition; the first status that comes back."""
        count = len(self.statuses)
        self.transitions.publish(
            PriorityTransition(hierarchy=hierarchy, duration=duration, **fields)
        )
        self.until(lambda: len(self.statuses) > count, "a status", 10.0)
        return self.statuses[count]

    def ask_with_id(self, request: str, hierarchy: str) -> None:
        """Send a transition under an id; its status is not waited for."""
        self.transitions.publish(PriorityTransition(id=request, hierarchy=hierarchy, duration=0.2))

    def refer(self, position: tuple[float, ...], task: str = "end_effector") -> None:
        """Send a standing reference."""
        self.references.publish(
            TaskReference(task=task, points=[TaskReferencePoint(position=list(position))])
        )

    def forge_state(self, ahead: float = 0.0, **changes: Any) -> None:
        """One state like the newest one, `ahead` of it [s], with fields changed.

        Joints are named in reverse order, which is sound and tells forged states from true ones.
        """
        assert self.state is not None
        message = JointState(name=JOINTS[::-1])
        for field in ("position", "velocity", "effort"):
            given = changes.pop(field, None)
            values = getattr(self.state, field) if given is None else [given] * len(JOINTS)
            setattr(message, field, list(values)[::-1])
        message.header.frame_id = changes.pop("frame_id", self.state.header.frame_id)
        stamp = nanoseconds_from_time(self.state.header.stamp) + round(ahead * NANOSECONDS)
        message.header.stamp = changes.pop("stamp", None) or time_from_nanoseconds(stamp)
        for field, value in changes.items():
            setattr(message, field, value)
        self.states_out.publish(message)

    def forge_command(self, effort: float, frame_id: str = "") -> None:
        """A command of one effort [Nm] for all joints that answers the newest state."""
        assert self.state is not None
        message = JointState(name=JOINTS[::-1], effort=[effort] * len(JOINTS))
        message.header.stamp, message.header.frame_id = self.state.header.stamp, frame_id
        self.commands_out.publish(message)

    def swing(self, seconds: float) -> None:
        """Send the arm to and fro for a while [s]; it is still moving at the end."""
        end, side = time.monotonic() + seconds, 0
        while time.monotonic() < end:
            self.refer(TARGETS[side % 2])
            side += 1
            self.spin(min(0.7, max(end - time.monotonic(), 0.0)))

    def call(self, service: str) -> str:
        """Call a Trigger service; its message."""
        client = self.node.create_client(Trigger, service)
        self.until(client.service_is_ready, service)
        future = client.call_async(Trigger.Request())
        self.until(future.done, f"the answer of {service}", 10.0)
        self.node.destroy_client(client)
        return str(future.result().message)

    def refused(self) -> int:
        """Messages that all nodes have rejected so far, as of their last diagnostics."""
        return sum(
            int(value)
            for values in self.diagnostics.values()
            for key, value in values.items()
            if key.startswith("rejected_")
        )

    def count(self, node: str, key: str) -> int:
        """A counter of the diagnostics of a node."""
        return int(self.diagnostics.get(node, {}).get(key, 0))

"""Nodes under test in a separate ROS domain, and a client that moves the robot and injects."""

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
from geometry_msgs.msg import WrenchStamped
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
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from benchmarks.faults.monitor import READY
from benchmarks.faults.subject import ARM, Subject
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
SCENE = ARM.scene
PATIENCE = 60.0  # [s] wall, for what must happen
STOP_PATIENCE = 20.0  # [s] wall, from a signal to the end of a process
REST = 0.5  # [s] simulated, for which a robot at rest stays so
AGAIN = 5.0  # [s] wall, after which a request without an answer is sent again
NODES = {
    "sim_bridge": ("ghc_sim_bridge", "sim_bridge"),
    "controller": ("ghc_controller", "controller"),
    "obstacle_bounds": ("ghc_mpc_constraints", "obstacle_bounds"),
    "contact_force_bounds": ("ghc_mpc_constraints", "contact_force_bounds"),
    "recorder": ("ghc_sim_bridge", "recorder"),
    "viewer": ("ghc_sim_bridge", "viewer"),
}
# Targets [m] between which the arm is sent to and fro, fast.
TARGETS = ((0.45, 0.30, 0.65), (0.45, -0.30, 0.55))


class Session:
    """Bridge, controller and monitor as processes; leaving the context ends them all."""

    def __init__(self, folder: Path, control_dt: float = 2e-3, subject: Subject = ARM) -> None:
        """Logs and recordings go to `folder`; `control_dt` [s] of bridge and controller."""
        self.folder = folder
        self.subject = subject
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
        self._started = self._asked = 0
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
        self.wrenches = create(WrenchStamped, "contacts/tool", CONTROL_PUBLISHER_QOS)
        self.ticks = create(Tick, "ghc/tick", CONTROL_PUBLISHER_QOS)
        self.epochs = create(Epoch, "sim_bridge/epoch", LATCHED_QOS)
        self.obstacles = create(ObstacleStateArray, "constraints/obstacles", CONTROL_PUBLISHER_QOS)
        self.odometry_out = create(Odometry, "odom", CONTROL_PUBLISHER_QOS)
        self.odometry: Odometry | None = None  # the newest true one, of a floating base
        self.names: dict[str, tuple[str, ...]] = {}  # of joints, in the robot's own messages
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
        if self.subject is not ARM:
            listen(Odometry, "odom", self._on_odometry, CONTROL_SUBSCRIBER_QOS)
        listen(ControllerState, "ghc/controller_state", self._on_report, STREAM_QOS)
        listen(TransitionStatus, "ghc/transition_status", self.statuses.append, RELIABLE_QOS)
        listen(ControllerMode, "ghc/controller_mode", self._on_mode, LATCHED_QOS)
        listen(PriorityMatrix, "ghc/priority_matrix", self.matrices.append, LATCHED_QOS)
        listen(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)

    def _on_state(self, message: JointState) -> None:
        if self._is_true("states", message):
            self.state = message

    def _on_command(self, message: JointState) -> None:
        if self._is_true("commands", message):
            self.command = message
            self.answered += 1

    def _is_true(self, topic: str, message: JointState) -> bool:
        """Ours name the joints in another order, and come later than the robot's first one."""
        names = JOINTS if self.subject is ARM else tuple(message.name)
        return self.names.setdefault(topic, names) == tuple(message.name)

    def _on_odometry(self, message: Odometry) -> None:
        if message.child_frame_id != "forged":
            self.odometry = message

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
        deadline = time.monotonic() + STOP_PATIENCE
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
            "sim_bridge": {
                "scene": self.subject.scene,
                "mode": "realtime",
                "control_dt": self.control_dt,
            },
            "controller": {"robot": self.subject.robot, "control_dt": self.control_dt},
        }.get(executable, {})
        values = {**defaults, **self.defaults.get(executable, {}), **parameters}
        arguments = [part for k, v in values.items() for part in ("-p", f"{k}:={v}")]
        command = [str(find_executable(*NODES[executable])), "--ros-args", *arguments]
        return self._run(name, command)

    def start_monitor(self) -> Path:
        """Start the monitor; returns its file."""
        if "monitor" in self.processes:  # of a run that has failed
            self.stop("monitor")
        path = self.folder / f"wire_{self._started}.npz"
        process = self._run("monitor", [sys.executable, "-m", "benchmarks.faults.monitor", path])
        self.until(lambda: READY in process.last_lines(), "the monitor")
        return path

    def kill(self, name: str) -> None:
        """Kill a node, as in a crash."""
        process = self.processes.pop(name)
        process.send(signal.SIGKILL)
        process.wait(time.monotonic() + STOP_PATIENCE)

    def stop(self, name: str) -> int | None:
        """Stop a node by a signal; returns its exit code."""
        process = self.processes.pop(name)
        process.send(signal.SIGINT)
        process.wait(time.monotonic() + PATIENCE)
        return process.exit_code

    def _run(self, name: str, command: list[Any]) -> NodeProcess:
        log = self.folder / f"{name}_{self._started}.log"
        self._started += 1
        process = NodeProcess(name, [str(part) for part in command], log, self._environment)
        self.processes[name] = process
        return process

    def output(self, name: str) -> str:
        """The output of a node."""
        return self.processes[name].last_lines(100000)

    def spin(self, seconds: float) -> None:
        """Spin for `seconds` [s] of wall time."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def until(self, condition: Callable[[], Any], what: str, timeout: float = PATIENCE) -> float:
        """Spin until `condition`; the elapsed time [s]. AssertionError after `timeout` [s]."""
        began = time.monotonic()
        while not condition():
            self._executor.spin_once(timeout_sec=0.005)
            if time.monotonic() - began > timeout:
                raise AssertionError(f"{what} did not come within {timeout:g} s")
        return time.monotonic() - began

    @property
    def now(self) -> float:
        """Simulated time of the newest state [s]."""
        assert self.state is not None
        return nanoseconds_from_time(self.state.header.stamp) / NANOSECONDS

    @property
    def speed(self) -> float:
        """Of the fastest joint in the newest state [rad/s]."""
        assert self.state is not None
        return max(map(abs, self.state.velocity))

    def pass_time(self, seconds: float) -> None:
        """Spin until `seconds` [s] of simulated time have passed."""
        end = self.now + seconds
        self.until(lambda: self.now >= end, f"{seconds:g} s of simulated time")

    def rest(self, slow: float, timeout: float = PATIENCE) -> float:
        """Spin until no joint has been faster than `slow` [rad/s] for REST; since when [s]."""
        since: float | None = None

        def rests() -> bool:
            nonlocal since
            if self.speed >= slow:
                since = None
            elif since is None:
                since = self.now
            return since is not None and self.now >= since + REST

        self.until(rests, "a robot at rest", timeout)
        assert since is not None
        return since

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
        """Send a transition; returns its first status.

        It is sent again while nothing comes: a controller that has just started may not have
        heard of this sender.
        """
        self._asked += 1
        fields = {"id": f"ask_{self._asked}"} | fields
        message = PriorityTransition(hierarchy=hierarchy, duration=duration, **fields)
        count, due = len(self.statuses), 0.0
        found: list[TransitionStatus] = []

        def answered() -> bool:
            nonlocal due
            found.extend(s for s in self.statuses[count:] if s.id == message.id)
            if not found and time.monotonic() >= due:
                self.transitions.publish(message)
                due = time.monotonic() + AGAIN
            return bool(found)

        self.until(self.transitions.get_subscription_count, "a reader of transitions")
        self.until(answered, "a status")
        return found[0]

    def ask_with_id(self, request: str, hierarchy: str) -> None:
        """Send a transition with an id, without waiting for its status."""
        self.transitions.publish(PriorityTransition(id=request, hierarchy=hierarchy, duration=0.2))

    def refer(self, position: tuple[float, ...], task: str = "end_effector") -> None:
        """Send a standing reference."""
        self.references.publish(
            TaskReference(task=task, points=[TaskReferencePoint(position=list(position))])
        )

    def forge_state(self, ahead: float = 0.0, **changes: Any) -> None:
        """One state like the newest one, `ahead` of it [s], with fields changed.

        One number is that of all joints, a list is sent as it is.

        Joints are named in reverse order, which is sound and tells forged states from true ones.
        """
        assert self.state is not None
        message = JointState(name=JOINTS[::-1])
        for field in ("position", "velocity", "effort"):
            given = changes.pop(field, None)
            if isinstance(given, list):
                setattr(message, field, given)
                continue
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

    def swing(self, seconds: float, speed: float = 0.0) -> None:
        """Send the arm to and fro for a while [s], and until a joint is as fast as `speed`."""
        end, due, side = time.monotonic() + seconds, 0.0, 0

        def moving() -> bool:
            nonlocal due, side
            now = time.monotonic()
            if now >= due:
                self.refer(TARGETS[side % 2])
                due, side = now + 0.7, side + 1
            return now >= end and self.speed >= speed

        self.until(moving, f"a joint as fast as {speed:g} rad/s", seconds + PATIENCE)

    def call(self, service: str) -> str:
        """Call a Trigger service; returns its message."""
        client = self.node.create_client(Trigger, service)
        self.until(client.service_is_ready, service)
        future = client.call_async(Trigger.Request())
        self.until(future.done, f"the answer of {service}")
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

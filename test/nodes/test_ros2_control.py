"""The mirrored commands drive a robot behind the controllers of ros2_control."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import (
    PriorityTransition,
    TaskReference,
    TaskReferencePoint,
    TransitionStatus,
)
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

from ghc_controller.ros.qos import CONTROL_SUBSCRIBER_QOS, RELIABLE_QOS
from ghc_sim_bridge.run.processes import NodeProcess
from ghc_sim_bridge.simulation.simulator import Simulator

TARGETS = {"end_effector": [0.61, 0.07, 0.82], "elbow": [0.0443, -0.3576, 0.4841]}  # [m]
FRAMES = {"end_effector": "tool", "elbow": "elbow"}
RATE = 200.0  # [Hz]
CONTROLLER = ["--ros-args", "-p", "robot:=kuka_lwr", "-p", f"control_dt:={1.0 / RATE}"]
BRAKED, HELD, COMMANDED = 2.0, 1.0, 0.0
DEADLINE = 90.0  # [s] wall
SLOW = 0.05  # [rad/s]
NEAR = 0.01  # [m]
SIMULATOR = Simulator("kuka_lwr")
ORDER = SIMULATOR.joint_names


class Operator:
    """Sends references and transitions, and sees what comes of them."""

    def __init__(self, context: Any) -> None:
        self.node = Node("operator", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.statuses: list[int] = []
        self.states: list[JointState] = []
        self.mirrored: list[list[float]] = []
        create, listen = self.node.create_publisher, self.node.create_subscription
        self.transitions = create(PriorityTransition, "ghc/priority_transition", RELIABLE_QOS)
        self._references = create(TaskReference, "ghc/task_reference", RELIABLE_QOS)
        self.efforts = create(Float64MultiArray, "/effort_controller/commands", 1)
        listen(TransitionStatus, "ghc/transition_status", self._on_status, RELIABLE_QOS)
        listen(JointState, "joint_states", self.states.append, CONTROL_SUBSCRIBER_QOS)
        listen(Float64MultiArray, "/effort_controller/commands", self._on_efforts, 1)

    def _on_status(self, message: TransitionStatus) -> None:
        self.statuses.append(message.status)

    def _on_efforts(self, message: Float64MultiArray) -> None:
        self.mirrored.append(list(message.data))

    def until(self, condition: Callable[[], Any], what: str) -> None:
        """Listen until something is so."""
        deadline = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < deadline, f"{what} did not come"
            self._executor.spin_once(timeout_sec=0.02)

    def spin(self, seconds: float) -> None:
        """Listen for a while [s]."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    @property
    def q(self) -> np.ndarray:
        """Positions of the newest state, in the order of the joints [rad]."""
        state = self.states[-1]
        return np.array([state.position[state.name.index(name)] for name in ORDER])

    @property
    def speed(self) -> float:
        """Of the fastest joint in the newest state [rad/s]."""
        return float(np.abs(self.states[-1].velocity).max())

    def arrive(self, task: str) -> None:
        """Listen until the frame of a task is near its target, and half a second longer."""
        self.until(lambda: distance(task, self.q) < 0.5 * NEAR, f"{task} at its target")
        self.spin(0.5)

    def rest(self) -> None:
        """Listen until no joint has been faster than SLOW for half a second."""
        since = time.monotonic()

        def rests() -> bool:
            nonlocal since
            since = since if self.speed < SLOW else time.monotonic()
            return time.monotonic() > since + 0.5

        self.until(rests, "an arm at rest")

    def is_driven(self) -> bool:
        """Whether the robot reports torques of one of the last commands."""
        torque = sorted(self.states[-1].effort)
        return any(sorted(command) == torque for command in self.mirrored[-50:])

    def wait_for_commands(self) -> None:
        """Listen until the mirror speaks and requests would be heard."""
        self.mirrored.clear()
        self.until(lambda: len(self.mirrored) > 20, "mirrored commands")
        self.until(lambda: self.states, "joint states")
        self.until(lambda: self.transitions.get_subscription_count() > 0, "the controller")

    def refer(self, task: str) -> None:
        """Send the target of a task."""
        point = TaskReferencePoint(position=TARGETS[task])
        self._references.publish(TaskReference(task=task, points=[point]))

    def swap(self, hierarchy: str) -> None:
        """Change priorities and wait until that is done."""
        self.statuses.clear()
        self.transitions.publish(PriorityTransition(hierarchy=hierarchy, duration=1.0))
        self.until(lambda: TransitionStatus.DONE in self.statuses or self._rejected, "a new order")
        assert not self._rejected

    @property
    def _rejected(self) -> bool:
        return TransitionStatus.REJECTED in self.statuses


@pytest.fixture
def robot(ros_domain_id: int, tmp_path: Path) -> Iterator[Callable[..., NodeProcess]]:
    """Start the robot with these options; its log is robot.npz in the folder of the test."""
    running: list[NodeProcess] = []

    def start(*options: str) -> NodeProcess:
        script = str(Path(__file__).with_name("effort_robot.py"))
        command = [sys.executable, script, "--log", str(tmp_path / "robot.npz"), *options]
        command += ["--rate", f"{RATE:g}"]
        path = os.pathsep.join([p or "." for p in sys.path])
        environment = os.environ | {"PYTHONPATH": path}
        running.append(NodeProcess("robot", command, tmp_path / "robot.log", environment))
        return running[-1]

    yield start
    for process in running:
        stop(process)


def stop(process: NodeProcess) -> None:
    """End the robot as Ctrl-C does."""
    process.send(signal.SIGINT)
    if not process.wait(time.monotonic() + 20.0):
        process.send(signal.SIGKILL)


def log_of(process: NodeProcess, folder: Path) -> dict[str, np.ndarray]:
    """What the robot wrote at its end."""
    stop(process)
    assert process.exit_code == 0, process.last_lines()
    with np.load(folder / "robot.npz") as data:
        return dict(data)


def distance(task: str, q: np.ndarray) -> float:
    """From the frame of a task to its target [m]."""
    SIMULATOR.reset(q)
    return float(np.linalg.norm(SIMULATOR.frame_position(FRAMES[task]) - TARGETS[task]))


def test_an_effort_controller_is_driven_through_holding_and_swaps(
    ros_context: Any,
    start_node: Callable[..., Any],
    robot: Callable[..., NodeProcess],
    tmp_path: Path,
) -> None:
    """States in an odd order of names, in a frame, and without effort: NaN, as upstream sends.
    Commands as a bare array."""
    driver = robot("--watchdog", "0.1", "--no-effort", "--frame", "base_link")
    start_node("ghc_controller", "controller", *CONTROLLER, "-p", "mirror_commands:=true")
    operator = Operator(ros_context)
    operator.wait_for_commands()
    names = list(operator.states[-1].name)
    assert names != sorted(names)
    assert np.isnan(operator.states[-1].effort).all()
    operator.spin(1.0)
    asked = time.time()
    for task in TARGETS:
        operator.refer(task)
    operator.swap("elbow > end_effector > posture")
    operator.arrive("elbow")
    swapped = time.time()
    operator.swap("end_effector > elbow > posture")
    operator.arrive("end_effector")

    log = log_of(driver, tmp_path)
    before = log["time"] < asked
    driven = log["source"] == COMMANDED
    assert (log["source"][0], driven.any()) == (BRAKED, True)
    assert np.abs(log["v"][before]).max() < SLOW  # holds where it is until it is asked
    assert np.abs(log["q"][before] - log["q"][0]).max() < 0.01
    first = log["q"][np.searchsorted(log["time"], swapped) - 1]
    assert distance("elbow", first) < NEAR
    assert distance("end_effector", first) > 0.1
    assert distance("end_effector", log["q"][-1]) < NEAR
    assert distance("elbow", log["q"][-1]) > 0.1
    assert log["dropped"] == log["wrong_size"] == 0


def test_a_dead_controller_is_noticed_by_stamps_alone(
    ros_context: Any,
    start_node: Callable[..., Any],
    robot: Callable[..., NodeProcess],
    tmp_path: Path,
) -> None:
    """Kill -9 in motion: the watchdog of the hardware holds the arm; a new controller goes on."""
    driver = robot("--watchdog", "0.1")
    arguments = [*CONTROLLER, "-p", "mirror_commands:=true"]
    controller = start_node("ghc_controller", "controller", *arguments)
    operator = Operator(ros_context)
    operator.wait_for_commands()
    operator.refer("end_effector")
    operator.until(lambda: operator.speed > 2.0 * SLOW, "an arm in motion")
    controller.send(signal.SIGKILL)
    controller.wait()
    operator.spin(0.5)  # the watchdog takes 0.1 s of the robot's clock
    operator.rest()
    rested = time.time()
    operator.spin(1.0)
    again = time.time()
    start_node("ghc_controller", "controller", *arguments)
    operator.wait_for_commands()
    operator.until(operator.is_driven, "a robot that is driven")
    operator.spin(1.0)

    log = log_of(driver, tmp_path)
    now = log["time"]
    quiet, after = (now > rested) & (now < again), now > again
    assert quiet.any() and (log["source"][quiet] == HELD).all()
    assert np.abs(log["v"][quiet]).max() < SLOW
    assert (log["source"][after] == COMMANDED).any()
    assert np.abs(log["v"][after]).max() < SLOW  # a restart moves nothing by itself


def test_without_a_watchdog_the_last_torque_stays_for_ever(
    ros_context: Any,
    start_node: Callable[..., Any],
    robot: Callable[..., NodeProcess],
    tmp_path: Path,
) -> None:
    """What docs/hardware.md warns of: nobody tells an effort controller that commands stopped."""
    driver = robot()
    controller = start_node(
        "ghc_controller", "controller", *CONTROLLER, "-p", "mirror_commands:=true"
    )
    operator = Operator(ros_context)
    operator.wait_for_commands()
    controller.send(signal.SIGKILL)
    controller.wait()
    operator.spin(1.0)  # what was on its way arrives
    killed, heard = time.time(), len(operator.states)
    operator.until(lambda: len(operator.states) > heard + 100, "states without a controller")
    wrong, due = time.time(), 0.0

    def is_off() -> bool:
        nonlocal due
        if time.monotonic() > due:
            due = time.monotonic() + 1.0
            operator.efforts.publish(Float64MultiArray(data=[0.0] * 6))  # one joint too few
        return not any(operator.states[-1].effort)

    operator.until(is_off, "a robot without torque")

    log = log_of(driver, tmp_path)
    after = log["torque"][(log["time"] > killed) & (log["time"] < wrong)]
    assert len(after) > 20
    assert (after == after[0]).all()
    assert np.abs(after[0]).max() > 1.0  # the weight of the arm, as it was
    assert log["wrong_size"] == 1
    assert (log["torque"][-1] == 0.0).all()  # deactivated: zero, whatever the arm weighs

"""Faults injected over DDS into the running nodes, in real time: each has a bounded outcome."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from ghc_msgs.msg import ControllerMode, PriorityTransition, TaskReference, TaskReferencePoint
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from benchmarks.faults.session import PATIENCE, Session
from benchmarks.faults.wire import Wire
from ghc_controller.ros.qos import CLOCK_QOS, CONTROL_SUBSCRIBER_QOS
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds

RATE = 1000.0 + 1e-3  # [Nm/s] the limit, and what rounding of stamps adds
SLOW = 0.05  # [rad/s]
FAST = 0.3  # [rad/s]
REST_PATIENCE = 20.0  # [s] wall, until a held robot is at rest
LIMIT = np.array([176.0, 176.0, 100.0, 100.0, 100.0, 38.0, 38.0])  # [Nm] of the URDF


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    """Bridge and controller in real time, for all tests of this module."""
    with Session(tmp_path_factory.mktemp("faults")) as session:
        session.start("sim_bridge")
        session.start("controller")
        session.ready()
        yield session


@pytest.fixture
def session(running: Session) -> Session:
    """Both nodes alive, and the robot driven."""
    for name in ("sim_bridge", "controller"):
        if name not in running.processes:
            running.start(name)
    running.ready()
    return running


def _watched(session: Session, fault: Callable[[], object], speed: float = 0.0) -> Wire:
    """What the monitor saw of a fault in motion, with a joint at least that fast [rad/s]."""
    path = session.start_monitor()
    session.swing(1.0, speed)
    fault()
    session.spin(1.0)
    assert session.stop("monitor") == 0
    return Wire.load(path)


def _goes_on(session: Session) -> None:
    """All nodes live, states are answered, and a request is served.

    How soon is judged by the campaign, on a machine that is not shared.
    """
    count = session.answered
    session.until(lambda: session.answered > count + 20, "answers")
    for name, process in session.processes.items():
        assert process.exit_code is None, session.output(name)
    assert session.ask("elbow > end_effector > posture", 0.1).reason == ""


def test_a_controller_killed_in_fast_motion(session: Session) -> None:
    """The applied rate stays within the limit, from command to hold and back, and the next
    controller keeps the robot where it is until it is asked for something."""
    held_since = np.inf

    def fault() -> None:
        nonlocal held_since
        session.kill("controller")
        held_since = session.rest(SLOW, REST_PATIENCE)  # by the bridge alone
        session.start("controller")
        session.ready()
        session.pass_time(2.0)

    session.ask("end_effector > elbow > posture", 0.1)
    wire = _watched(session, fault, FAST)
    assert np.abs(wire.velocity).max() >= FAST, "the arm was moving"
    assert wire.largest_rate(session.control_dt) <= RATE
    assert session.mode.mode == ControllerMode.HOLDING
    held = wire.stamp > held_since
    assert np.count_nonzero(held) > 100
    assert np.abs(wire.velocity[held]).max() < SLOW
    _goes_on(session)
    session.until(lambda: session.mode.mode == ControllerMode.ACTIVE, "the mode")


@pytest.mark.parametrize("lie", [-1e4, 1e300, float("nan")])
def test_reported_efforts_are_not_believed(session: Session, lie: float) -> None:
    def fault() -> None:
        for _ in range(20):
            session.forge_state(ahead=session.control_dt, effort=lie)
            session.spin(0.02)

    wire = _watched(session, fault)
    assert wire.largest_rate(session.control_dt) <= RATE
    assert wire.largest_command_rate(session.control_dt) <= RATE
    assert wire.largest_share(LIMIT) < 0.5
    _goes_on(session)


ONE_STATE: list[dict[str, Any]] = [
    {"ahead": 3600.0},
    {"stamp": Time(sec=2**31 - 1, nanosec=4_000_000_000)},
    {"stamp": Time(sec=2**31 - 1, nanosec=999_999_999)},
    {"stamp": Time(sec=-(2**31))},
    {"velocity": 1e3},
    {"position": 1e300},
    {"name": ["x"] * 100_000},
]


@pytest.mark.parametrize("forged", ONE_STATE, ids=lambda f: ", ".join(f))
@pytest.mark.parametrize("copies", [1, 5])
def test_a_forged_state_costs_no_more_than_itself(
    session: Session, forged: dict[str, Any], copies: int
) -> None:
    for _ in range(copies):
        session.forge_state(**forged)
    _goes_on(session)
    session.until(lambda: session.mode.mode == ControllerMode.ACTIVE, "the mode")


def test_bytes_that_are_no_message_end_no_node(session: Session) -> None:
    """Four bytes on every topic that controller and bridge read."""
    for publisher in (
        session.states_out,
        session.commands_out,
        session.transitions,
        session.references,
    ):
        for _ in range(5):
            publisher.publish(b"\x00\x01\x00\x00")
            session.spin(0.02)
    _goes_on(session)


@pytest.mark.parametrize(
    "point",
    [
        {"position": [1e6, 0.0, 0.0]},
        {"position": [1e300, 0.0, 0.0]},
        {"position": [0.5, 0.0, 0.5], "velocity": [1e5, 0.0, 0.0]},
        {"position": [0.5, 0.0, 0.5], "velocity": [0.0] * 3, "acceleration": [1e9, 0.0, 0.0]},
    ],
    ids=["far", "farther", "fast", "sharp"],
)
def test_implausible_references_are_rejected(session: Session, point: dict[str, Any]) -> None:
    key, due = "rejected_ghc/task_reference", 0.0
    before, said = session.count("controller", key), len(session.output("controller"))

    def told() -> bool:
        """Sent again every two seconds: the log has one warning a second."""
        nonlocal due
        if time.monotonic() >= due:
            session.references.publish(
                TaskReference(task="end_effector", points=[TaskReferencePoint(**point)])
            )
            due = time.monotonic() + 2.0
        lines = session.output("controller")[said:].splitlines()
        return any("ghc/task_reference" in line and "expected" in line for line in lines)

    session.until(told, "a reason in the log")
    session.until(lambda: session.count("controller", key) > before, key)
    _goes_on(session)


def test_huge_requests_are_rejected_while_states_are_answered(session: Session) -> None:
    """A hierarchy of 1e6 characters, one of 2e4 names, a reference of 1e5 points: no hold."""
    count = len(session.statuses)
    names = " > ".join(f"t{k}" for k in range(20_000))
    for hierarchy in ("x" * 1_000_000, names):
        session.transitions.publish(PriorityTransition(hierarchy=hierarchy))
    session.until(lambda: len(session.statuses) >= count + 2, "the refusals")
    for status in session.statuses[count:]:
        assert "bytes given, at most" in status.reason
    points = [TaskReferencePoint(position=[0.4, 0.1, 0.5])] * 100_000
    for k, point in enumerate(points[:3]):
        point.time_from_start.sec = k
    session.references.publish(TaskReference(task="elbow", points=points))
    _goes_on(session)


def test_a_late_stamp_does_not_make_alpha_jump(session: Session) -> None:
    """A ramp that should have begun 1.5 s ago begins now, at its own speed."""
    session.ask("end_effector > elbow > posture", 0.05)
    session.until(lambda: _in_force(session, "end_effector > elbow > posture"), "the first order")
    first = np.array(session.matrices[-1].alpha)
    session.matrices.clear()
    now = session.now
    late = Header(stamp=time_from_seconds(now - 1.5))
    assert session.ask("posture > elbow > end_effector", 2.0, header=late).reason == ""
    session.until(lambda: _in_force(session, "posture > elbow > end_effector"), "the next order")
    time_s = np.array([nanoseconds_from_time(m.header.stamp) * 1e-9 for m in session.matrices])
    alpha = np.array([m.alpha for m in session.matrices])
    speed = np.abs(np.diff(alpha, axis=0)).max(axis=1) / np.maximum(np.diff(time_s), 1e-3)
    assert speed.max() <= 1.05 * np.pi / 2 / 2.0  # of a cosine over 2 s
    ramp = 0.5 - 0.5 * np.cos(np.pi * np.clip((time_s - now) / 2.0, 0.0, 1.0))
    assert (np.abs(alpha - first).max(axis=1) <= ramp + 1e-6).all()  # no further than from now on


def _in_force(session: Session, hierarchy: str) -> bool:
    """Whether an order is in force, and no ramp."""
    newest = session.matrices[-1:]
    return any(m.hierarchy == hierarchy and not m.in_transition for m in newest)


def test_a_second_commander_is_named_and_ignored(session: Session) -> None:
    """Full torque, zero and absurd commands of another sender, as fresh as they can be."""
    key = "rejected_second_commander"
    before = session.count("sim_bridge", key)

    def fault() -> None:
        end = time.monotonic() + PATIENCE
        rounds = 0
        while rounds < 10 or session.count("sim_bridge", key) <= before + 10:
            assert time.monotonic() < end
            rounds += 1
            for effort in (0.0, 38.0, 1e300, -1e4):
                session.forge_command(effort, "intruder")
                session.spin(0.01)
                session.forge_command(effort)
                session.spin(0.01)

    wire = _watched(session, fault)
    assert wire.largest_rate(session.control_dt) <= RATE
    assert wire.largest_share(LIMIT) < 0.3
    said = session.output("sim_bridge")
    assert "ignored while 'controller_" in said  # whose command came at the time of a warning
    assert "/fault_injector" in said
    _goes_on(session)


@pytest.mark.parametrize("effort", [1e300, 0.0, -1e4])
def test_a_silent_controller_loses_the_robot_to_no_intruder(
    session: Session, effort: float
) -> None:
    """It is stopped for longer than its claim lasts, while another sender keeps on: held, then
    driven by the controller again."""

    key = "rejected_takeover"
    before = session.count("sim_bridge", key)

    def forge(count: int) -> None:
        for _ in range(count):
            session.forge_command(effort)
            session.spin(0.015)

    def fault() -> None:
        controller = session.processes["controller"]
        controller.send(signal.SIGSTOP)
        end = time.monotonic() + PATIENCE
        forge(60)
        while session.count("sim_bridge", key) <= before and time.monotonic() < end:
            forge(1)
        controller.send(signal.SIGCONT)
        forge(40)

    wire = _watched(session, fault)
    assert wire.largest_rate(session.control_dt) <= RATE
    assert wire.largest_share(LIMIT) < 0.5
    assert session.count("sim_bridge", key) > before
    _goes_on(session)


def test_a_second_bridge_does_not_start(session: Session) -> None:
    second = session.start("second", "sim_bridge")
    assert second.wait(time.monotonic() + PATIENCE)
    said = session.output("second")
    assert session.processes.pop("second").exit_code in (1, 2)  # found at the start, or after it
    assert "joint_states is published already by" in said
    assert "/sim_bridge" in said.partition("published already by")[2].partition(": one bridge")[0]
    _goes_on(session)


def test_a_fault_is_latched_until_it_is_reset(session: Session) -> None:
    """States that are implausible for long: latched; requests rejected; reset, armed, active."""
    session.ask("elbow > end_effector > posture", 0.1)
    end = time.monotonic() + PATIENCE
    while session.mode.mode != ControllerMode.LATCHED and time.monotonic() < end:
        session.forge_state(ahead=session.control_dt, position=1.9)  # from where no joint is
        session.spin(0.0005)
    assert session.mode.mode == ControllerMode.LATCHED
    assert "joint_" in session.mode.reason
    assert "latched" in session.ask("posture", 0.1).reason
    assert "holding" in session.call("controller/reset_fault")
    session.until(lambda: session.mode.mode == ControllerMode.HOLDING, "the mode")
    session.rest(SLOW, REST_PATIENCE)
    assert "active" in session.call("controller/arm")
    assert "holding" in session.call("controller/hold")
    _goes_on(session)
    session.until(lambda: session.mode.mode == ControllerMode.ACTIVE, "the mode")


@pytest.mark.parametrize(
    ("sides", "own_clocks", "apart"),
    [
        pytest.param(("left", "right"), False, 0.0, id="shared"),
        pytest.param(("right", "left"), False, 0.7, id="shared-apart"),
        pytest.param(("right", "left"), True, 0.7, id="own"),
    ],
)
def test_two_robots_in_namespaces_have_clocks_that_never_go_back(
    ros_context: Any,
    start_node: Callable[..., Any],
    sides: tuple[str, str],
    own_clocks: bool,
    apart: float,
) -> None:
    """Started at once or `apart` [s]; with one clock for both, or a topic for each."""
    node = Node("listener", context=ros_context)
    stamps: dict[str, list[int]] = {}
    seen: set[str] = set()
    for topic in [f"/{side}/clock" for side in sides] if own_clocks else ["/clock"]:
        node.create_subscription(
            Clock, topic, partial(_note_time, stamps.setdefault(topic, [])), CLOCK_QOS
        )
    for side in sides:
        arguments = f"--ros-args -r __ns:=/{side} -p scene:=kuka_lwr -p mode:=realtime".split()
        if own_clocks:
            arguments += ["-r", f"/clock:=/{side}/clock"]
        start_node("ghc_sim_bridge", "sim_bridge", *arguments)
        node.create_subscription(
            JointState, f"/{side}/joint_states", partial(_note, seen, side), CONTROL_SUBSCRIBER_QOS
        )
        _spin(node, ros_context, apart)
    end = time.monotonic() + 2 * PATIENCE
    while time.monotonic() < end and (len(seen) < 2 or min(map(len, stamps.values())) <= 100):
        _spin(node, ros_context, 0.1)
    _spin(node, ros_context, 1.5)
    assert seen == set(sides)
    for heard in stamps.values():
        assert len(heard) > 100
        steps = np.diff(heard)
        assert (steps >= 0).all(), (heard[int(np.argmin(steps))], steps.min())
    node.destroy_node()


def _note_time(heard: list[int], message: Clock) -> None:
    heard.append(nanoseconds_from_time(message.clock))


def _note(seen: set[str], side: str, _: JointState) -> None:
    seen.add(side)


def _spin(node: Node, context: Any, seconds: float) -> None:
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    executor.remove_node(node)
    executor.shutdown()

"""The controller as a process: every state answered, every bad request rejected with a reason."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Duration, Time
from ghc_msgs.msg import (
    ControllerMode,
    ControllerState,
    Epoch,
    PriorityMatrix,
    PriorityTransition,
    TaskReference,
    TaskReferencePoint,
    TaskReferenceStatus,
    TransitionStatus,
)
from rclpy.duration import Duration as Wait
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from ghc_controller.formulations import DEFAULT_FORMULATION
from ghc_controller.ros.qos import (
    CONTROL_PUBLISHER_QOS,
    CONTROL_SUBSCRIBER_QOS,
    LATCHED_QOS,
    RELIABLE_QOS,
    STREAM_QOS,
)
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.ros.wire.epochs import EPOCH_TOPIC

JOINTS = [f"joint_{i}" for i in range(1, 8)]
HOME = [0.1, -0.4, 0.1, 1.4, 0.1, -1.0, 0.1]
DEADLINE = 90.0  # [s] wall, for anything that must happen
STEP = 1e-3  # [s]
NAN = float("nan")


class Robot:
    """A robot that stands still: publishes states, remembers all that the controller says."""

    def __init__(self, context: Any) -> None:
        self.node = Node("robot", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self.commands: list[JointState] = []
        self.statuses: list[TransitionStatus] = []
        self.states: list[ControllerState] = []
        self.replies: list[TaskReferenceStatus] = []
        self.matrices: list[PriorityMatrix] = []
        self.time = 0.0
        create = self.node.create_publisher
        self._states = create(JointState, "joint_states", CONTROL_PUBLISHER_QOS)
        self._transitions = create(PriorityTransition, "ghc/priority_transition", RELIABLE_QOS)
        self._epochs = create(Epoch, EPOCH_TOPIC, LATCHED_QOS)
        self._references = create(TaskReference, "ghc/task_reference", RELIABLE_QOS)
        listen = self.node.create_subscription
        listen(JointState, "joint_commands", self.commands.append, CONTROL_SUBSCRIBER_QOS)
        listen(TransitionStatus, "ghc/transition_status", self.statuses.append, RELIABLE_QOS)
        listen(TaskReferenceStatus, "ghc/task_reference_status", self.replies.append, RELIABLE_QOS)
        listen(ControllerState, "ghc/controller_state", self.states.append, STREAM_QOS)
        listen(PriorityMatrix, "ghc/priority_matrix", self.matrices.append, LATCHED_QOS)

    def until(
        self,
        condition: Callable[[], bool],
        again: Callable[[], None] | None = None,
        every: float = 0.1,
    ) -> None:
        """Spin until `condition`, doing `again` now and `every` so many seconds, or fail."""
        deadline, due = time.monotonic() + DEADLINE, 0.0
        while not condition():
            assert time.monotonic() < deadline, "nothing came"
            if again is not None and time.monotonic() > due:
                again()
                due = time.monotonic() + every
            self._executor.spin_once(timeout_sec=0.02)

    def publish(self, **changes: Any) -> None:
        """One joint state at the present time, with fields changed."""
        message = JointState(name=JOINTS, position=HOME, velocity=[0.0] * 7, effort=[0.0] * 7)
        message.header.stamp = time_from_seconds(self.time)
        for field, value in changes.items():
            setattr(message, field, value)
        self._states.publish(message)

    def announce(self, number: int, start: float) -> None:
        """A run begins at `start` [s]; the controller has heard so a while later."""
        self.until(lambda: self._epochs.get_subscription_count() > 0)
        self._epochs.publish(Epoch(number=number, start=time_from_seconds(start)))
        assert self._epochs.wait_for_all_acked(Wait(seconds=DEADLINE))
        self.spin(0.2)

    def spin(self, seconds: float) -> None:
        """Let things happen for a while [s]."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    def send(self, **fields: Any) -> None:
        """Send a transition; its status is not waited for."""
        self._transitions.publish(PriorityTransition(**fields))
        assert self._transitions.wait_for_all_acked(Wait(seconds=DEADLINE))
        self.spin(0.2)

    def answer(self, **changes: Any) -> JointState:
        """The command for a state at the present time (repeated until it comes)."""
        wanted = nanoseconds_from_time(time_from_seconds(self.time))
        count = len(self.commands)

        def answered() -> bool:
            return any(
                nanoseconds_from_time(c.header.stamp) == wanted for c in self.commands[count:]
            )

        self.until(answered, lambda: self.publish(**changes))
        return self.commands[-1]

    def step(self, **changes: Any) -> JointState:
        """Advance the time by one period and get the command."""
        self.time = round(self.time + STEP, 9)
        return self.answer(**changes)

    def ask(self, **fields: Any) -> list[TransitionStatus]:
        """Send a transition; the statuses that came back for it first.

        It is sent again while nothing comes: a controller may not have heard of its sender yet.
        """
        count, request = len(self.statuses), PriorityTransition(**fields)
        self.until(
            lambda: len(self.statuses) > count,
            lambda: self._transitions.publish(request),
            every=20.0,
        )
        return self.statuses[count:]

    def refer(self, message: TaskReference) -> None:
        """Send a reference."""
        self._references.publish(message)

    def count(self, name: str) -> int:
        """A counter of the newest controller_state."""
        return {c.name: c.count for c in self.states[-1].counts}.get(name, 0)


def _connected(context: Any, start_node: Callable[..., Any], **parameters: object) -> Robot:
    """A robot with a controller that has answered its first state."""
    values = {"robot": "kuka_lwr", "state_rate": 1000.0, "lockstep": "true"} | parameters
    pairs = [part for name, value in values.items() for part in ("-p", f"{name}:={value}")]
    start_node("ghc_controller", "controller", "--ros-args", *pairs)
    robot = Robot(context)
    robot.answer()
    robot.until(
        lambda: (
            robot._transitions.get_subscription_count() > 0
            and robot._references.get_subscription_count() > 0
            and robot._states.get_subscription_count() > 0
            and len(robot.matrices) > 0
        ),
        robot.publish,
    )
    robot.until(lambda: len(robot.states) > 0, robot.step)
    return robot


@pytest.fixture
def robot(
    ros_context: Any, start_node: Callable[..., Any], request: pytest.FixtureRequest
) -> Iterator[Robot]:
    """A connected robot, its torques decided by the state alone; param: its formulation."""
    formulation = getattr(request, "param", DEFAULT_FORMULATION)
    robot = _connected(ros_context, start_node, formulation=formulation, torque_rate_limit=0.0)
    yield robot
    robot.node.destroy_node()


BAD_REQUESTS: list[tuple[dict[str, Any], list[str]]] = [
    ({"tasks": ["elbow", "posture"], "alpha": [0.0, 1.0, 0.0]}, ["size 3 given", "4 expected"]),
    ({"tasks": ["wrist"], "alpha": [0.0]}, ["unknown task 'wrist'", "end_effector, elbow, post"]),
    ({"hierarchy": "elbow > wrist"}, ["unknown task 'wrist'", "end_effector, elbow, posture"]),
    ({"tasks": ["elbow"], "alpha": [float("nan")]}, ["nan given", "[0, 1] expected"]),
    ({"tasks": ["elbow", "posture"], "alpha": [0.0, 1.5, 0.0, 0.0]}, ["1.5", "[0, 1]"]),
    ({"hierarchy": "elbow > posture", "duration": -1.0}, ["duration = -1.0", "at least 0"]),
    ({"hierarchy": "elbow >> posture"}, ["malformed", "'a > b = c'"]),
    ({"hierarchy": "elbow", "profile": "square"}, ["square", "cosine, linear, minimum_jerk"]),
    ({}, ["neither hierarchy nor tasks", "end_effector > elbow > posture"]),
    ({"hierarchy": "elbow", "tasks": ["elbow"], "alpha": [0.0]}, ["both", "one of them"]),
    (
        {"tasks": ["end_effector", "elbow", "posture"], "alpha": [1.0] * 9},
        ["no task is left", "end_effector, elbow, posture"],
    ),
]


def test_bad_transitions_are_refused_and_the_loop_goes_on(robot: Robot) -> None:
    """REJECTED with what was given, expected and exists; the next state is answered as before."""
    before = robot.step()
    for number, (fields, words) in enumerate(BAD_REQUESTS):
        (status,) = robot.ask(id=f"bad {number}", **fields)
        assert status.status == TransitionStatus.REJECTED
        assert status.id == f"bad {number}"
        for word in words:
            assert word in status.reason
        assert np.allclose(robot.step().effort, before.effort, atol=1e-9)
    name = "rejected_ghc/priority_transition"
    robot.until(lambda: robot.count(name) == len(BAD_REQUESTS), robot.step)
    assert robot.matrices[-1].hierarchy == "end_effector > elbow > posture"


@pytest.mark.parametrize(
    "robot",
    ["task_priority", "resolved_acceleration", "operational_space", "unifying"],
    indirect=True,
)
def test_formulations_of_strict_orders_reject_any_other_matrix(robot: Robot) -> None:
    """REJECTED with the reason; an order is accepted, runs, and is active."""
    between = [0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0]
    (status,) = robot.ask(id="half", tasks=["end_effector", "elbow", "posture"], alpha=between)
    assert status.status == TransitionStatus.REJECTED
    for word in ("knows orders only", "elbow"):
        assert word in status.reason
    swapped = "elbow > end_effector > posture"
    (accepted, *_) = robot.ask(id="swap", hierarchy=swapped)
    assert accepted.status == TransitionStatus.ACCEPTED
    robot.until(
        lambda: (
            robot.matrices[-1].hierarchy == swapped
            and robot.statuses[-1].status == TransitionStatus.DONE
        ),
        robot.step,
    )


@pytest.mark.parametrize("robot", ["rhp_hqp", "hqp_transition"], indirect=True)
def test_formulations_of_orders_refuse_other_matrices(robot: Robot) -> None:
    """REJECTED with the entries and the formulation; an order is accepted, and states answered."""
    before = robot.step()
    tasks = {"tasks": ["elbow", "posture"]}
    (status,) = robot.ask(alpha=[0.0, 0.2, 0.7, 0.0], **tasks)
    assert status.status == TransitionStatus.REJECTED
    for word in ("knows orders only", "alpha[elbow, posture] = 0.2", "neither strict nor equal"):
        assert word in status.reason
    assert np.allclose(robot.step().effort, before.effort, atol=1e-9)
    status = robot.ask(alpha=[0.0, 0.0, 1.0, 0.0], duration=1.0, **tasks)[0]
    assert status.status == TransitionStatus.ACCEPTED
    assert np.isfinite(robot.step().effort).all()


def test_late_request_is_refused_in_lockstep(robot: Robot) -> None:
    """A start that has passed would make the run depend on the arrival."""
    robot.time = 1.0
    robot.answer()
    message = {"hierarchy": "elbow > posture", "duration": 1.0}
    late = PriorityTransition(**message)
    late.header.stamp = time_from_seconds(0.5)
    (status,) = robot.ask(header=late.header, **message)
    assert status.status == TransitionStatus.REJECTED
    assert "start 0.5 s given" in status.reason


def test_transition_by_stamp_runs_and_reports(robot: Robot) -> None:
    """ACCEPTED before its time, ACTIVE and DONE at their times, alpha of eq. 15 in between."""
    request = PriorityTransition(hierarchy="elbow > end_effector > posture", duration=0.02)
    request.header.stamp = time_from_seconds(0.01)
    statuses = robot.ask(
        id="swap", header=request.header, hierarchy=request.hierarchy, duration=request.duration
    )
    assert statuses[0].status == TransitionStatus.ACCEPTED
    for _ in range(35):
        robot.step()
    robot.until(lambda: robot.statuses[-1].status == TransitionStatus.DONE, robot.publish)
    seen = [(status.status, _seconds(status.header.stamp)) for status in robot.statuses]
    assert seen[1:] == [(TransitionStatus.ACTIVE, 0.01), (TransitionStatus.DONE, 0.03)]
    ramp = [s for s in robot.states if 0.01 <= _seconds(s.header.stamp) <= 0.03]
    assert len(ramp) > 3  # of 21: a report may be lost
    for report in ramp:
        progress = (_seconds(report.header.stamp) - 0.01) / 0.02
        assert np.isclose(report.alpha[1], 0.5 - 0.5 * np.cos(np.pi * progress), atol=1e-9)


def test_repeat_of_the_target_changes_nothing(robot: Robot) -> None:
    """`ros2 topic pub` without --once: accepted, done, no ramp."""
    robot.step()
    count = len(robot.statuses)
    robot.ask(hierarchy="end_effector > elbow > posture", duration=2.0)
    robot.until(lambda: len(robot.statuses) >= count + 2)
    assert [s.status for s in robot.statuses[count:]] == [
        TransitionStatus.ACCEPTED,
        TransitionStatus.DONE,
    ]
    assert not robot.matrices[-1].in_transition


def test_repeat_during_its_ramp_is_not_done_early(robot: Robot) -> None:
    """DONE comes once, when the ramp is over."""
    robot.step()
    count = len(robot.statuses)
    again = {"hierarchy": "elbow > end_effector > posture", "duration": 0.01, "id": "same"}
    robot.ask(**again)
    robot.step()
    robot.until(lambda: robot.statuses[-1].status == TransitionStatus.ACTIVE)
    robot.ask(**again)
    assert robot.statuses[-1].status == TransitionStatus.ACCEPTED
    for _ in range(15):
        robot.step()
    robot.until(lambda: robot.statuses[-1].status == TransitionStatus.DONE)
    assert [s.status for s in robot.statuses[count:]] == [
        TransitionStatus.ACCEPTED,
        TransitionStatus.ACTIVE,
        TransitionStatus.ACCEPTED,
        TransitionStatus.DONE,
    ]


BAD_STATES: list[tuple[str, Any, str]] = [
    ("position", [*HOME[:6], NAN], "joint_states.position"),
    ("velocity", [float("inf")] + [0.0] * 6, "joint_states.velocity"),
    ("position", HOME[:5], "joint_states.position"),
    ("name", [*JOINTS[:6], "gripper"], "joint_states.name"),
]


def test_bad_states_are_not_answered(robot: Robot) -> None:
    """A malformed state is dropped and counted by field; the next good one is answered."""
    for field, value, counter in BAD_STATES:
        robot.step()
        name = f"rejected_{counter}"
        more = partial(_more, robot, name, robot.count(name))
        bad_ns: set[int] = set()
        robot.until(more, partial(_bad_and_good, robot, {field: value}, bad_ns))
        assert bad_ns.isdisjoint(nanoseconds_from_time(c.header.stamp) for c in robot.commands)


def test_repeated_state_same_command(robot: Robot) -> None:
    """The state's stamp is its sequence number; an older one is not answered."""
    robot.step()
    robot.step()
    first = robot.commands[-1]
    count = len(robot.commands)
    robot.until(lambda: len(robot.commands) > count, robot.publish)
    assert list(robot.commands[-1].effort) == list(first.effort)
    now, robot.time = robot.time, 0.0
    for _ in range(5):
        robot.publish()
    robot.time = now
    robot.step()
    stamps = [nanoseconds_from_time(c.header.stamp) for c in robot.commands[count:]]
    assert 0 not in stamps


def test_a_new_run_starts_afresh(robot: Robot) -> None:
    """After a reset transitions of the past are gone, and what is stamped in it is rejected."""
    robot.announce(0, 0.0)
    robot.time = 5.0
    robot.answer()
    robot.ask(hierarchy="posture", duration=0.0)
    robot.step()
    robot.until(lambda: robot.matrices[-1].hierarchy == "posture", robot.publish)
    robot.announce(1, 7.0)
    early = Time(sec=7, nanosec=5_000_000)
    robot.send(id="early", hierarchy="elbow", header=Header(stamp=early), duration=0.0)
    robot.time = 7.0
    robot.answer()
    robot.until(
        lambda: robot.matrices[-1].hierarchy == "end_effector > elbow > posture", robot.publish
    )
    (status,) = robot.ask(id="late", hierarchy="posture", header=Header(stamp=Time(sec=6)))
    assert status.id == "late"
    assert "start 6 s given, which is of a run that has ended" in status.reason
    assert [s.status for s in robot.statuses if s.id == "early"] == [TransitionStatus.ACCEPTED]
    for _ in range(7):
        robot.step()
    robot.until(lambda: robot.matrices[-1].hierarchy == "elbow", robot.publish)


def test_references(robot: Robot) -> None:
    """A good reference moves the target; bad ones are rejected and counted."""
    robot.step()
    good = TaskReference(task="end_effector")
    good.points = [TaskReferencePoint(position=[0.4, 0.1, 0.5])]
    robot.refer(good)
    robot.until(lambda: _reference(robot) == [0.4, 0.1, 0.5], robot.step)
    bad = [
        TaskReference(task="wrist", points=good.points),
        TaskReference(task="end_effector"),
        TaskReference(task="end_effector", points=[TaskReferencePoint(position=[0.4, 0.1])]),
        TaskReference(
            task="elbow", points=[TaskReferencePoint(position=[0.4, 0.1, float("nan")])]
        ),
        TaskReference(task="elbow", joints=JOINTS, points=good.points),
    ]
    for k, message in enumerate(bad):
        message.id = f"bad {k}"
        robot.refer(message)
    robot.until(lambda: robot.count("rejected_ghc/task_reference") == len(bad), robot.step)
    assert _reference(robot) == [0.4, 0.1, 0.5]
    robot.until(lambda: len(robot.replies) == 1 + len(bad))
    first, *others = robot.replies
    assert (first.status, first.task) == (TaskReferenceStatus.ACCEPTED, "end_effector")
    assert [reply.id for reply in others] == [message.id for message in bad]
    assert {reply.status for reply in others} == {TaskReferenceStatus.REJECTED}
    assert all(reply.reason for reply in others)


def test_a_reference_of_several_points_is_done_or_replaced(robot: Robot) -> None:
    """Three periods long; the second one is replaced by a standing target after one."""
    robot.step()
    points = [
        TaskReferencePoint(position=[0.4, 0.1, 0.5]),
        TaskReferencePoint(position=[0.4, 0.1, 0.51], time_from_start=Duration(nanosec=3_000_000)),
    ]
    for name in ("first", "second"):
        robot.refer(TaskReference(id=name, task="elbow", points=points))
        robot.until(lambda: [r.id for r in robot.replies[-1:]] == [name])  # noqa: B023
        robot.step()
        if name == "second":
            robot.refer(TaskReference(id="third", task="elbow", points=points[:1]))
            robot.until(lambda: robot.replies[-1].id == "third")
        for _ in range(4):
            robot.step()
    robot.until(lambda: len(robot.replies) == 5)
    assert [(r.id, r.status) for r in robot.replies] == [
        ("first", TaskReferenceStatus.ACCEPTED),
        ("first", TaskReferenceStatus.DONE),
        ("second", TaskReferenceStatus.ACCEPTED),
        ("third", TaskReferenceStatus.ACCEPTED),
        ("second", TaskReferenceStatus.REPLACED),
    ]


def test_torque_stays_inside_rate_and_limits(
    ros_context: Any, start_node: Callable[..., Any]
) -> None:
    """A target far away: no command steps by more than 1 Nm per ms, whatever is reported."""
    robot = _connected(ros_context, start_node)
    far = TaskReference(task="end_effector")
    far.points = [TaskReferencePoint(position=[1.5, -1.5, 1.5])]
    before = list(robot.step().effort)
    robot.refer(far)
    for lie in [-1e4, 0.0, 1e300, 30.0] * 25:
        command = list(robot.step(effort=[lie] * 7).effort)
        assert np.abs(np.subtract(command, before)).max() <= 1.0 + 1e-9
        assert (np.abs(command) <= [176, 176, 100, 100, 100, 38, 38]).all()
        before = command


def test_a_run_whose_first_state_is_refused_begins_with_the_next_one(
    ros_context: Any, start_node: Callable[..., Any]
) -> None:
    """In real time: waiting while a joint is outside its limits, then holding at its own time."""
    robot = _connected(ros_context, start_node, lockstep="false")
    modes: list[ControllerMode] = []
    robot.node.create_subscription(
        ControllerMode, "ghc/controller_mode", modes.append, LATCHED_QOS
    )
    robot.time = 5.0  # as after a cut link
    robot.answer()
    assert robot.ask(hierarchy="posture > elbow", duration=0.0)[0].reason == ""
    robot.until(lambda: modes[-1].mode == ControllerMode.ACTIVE)
    robot.announce(1, 7.0)
    robot.time = 7.0
    outside = partial(robot.publish, position=[0.1, 3.0, *HOME[2:]])
    robot.until(lambda: modes[-1].mode == ControllerMode.WAITING, outside)
    assert "joint_2" in modes[-1].reason
    assert "waiting" in robot.ask(hierarchy="posture")[0].reason
    robot.answer()
    robot.until(lambda: modes[-1].mode == ControllerMode.HOLDING)
    robot.step()
    robot.until(lambda: list(robot.matrices[-1].alpha) == list(robot.matrices[0].alpha))


BAD_PARAMETERS: list[tuple[str, list[str]]] = [
    ("-p robot:=pr2", ["unknown robot 'pr2'", "kuka_lwr"]),
    ("-p robot:=/nowhere/robot.yaml", ["/nowhere/robot.yaml"]),
    ("-p robot:=kuka_lwr -p formulation:=sot", ["unknown formulation 'sot'", "balanced"]),
    ("-p robot:=kuka_lwr -p qp_solver:=osqp", ["unknown QP solver 'osqp'", "daqp, proxqp"]),
    ("-p robot:=kuka_lwr -p control_dt:=-1.0", ["control_dt", "above 0"]),
    ("-p robot:=kuka_lwr -p hierarchy:='a > b'", ["unknown task 'a'", "end_effector"]),
    ("-p robot:=kuka_lwr -p speed:=1.0", ["unknown parameter 'speed'", "formulation"]),
    ("-p robot:=kuka_lwr -p velocity_limit:=fast", ["velocity_limit", "a number >= 0 expected"]),
]


def test_bad_parameters_end_with_one_line(start_node: Callable[..., Any]) -> None:
    """One clear line on stderr, exit code 2, no traceback."""
    for arguments, words in BAD_PARAMETERS:
        node = start_node("ghc_controller", "controller", "--ros-args", *shlex.split(arguments))
        assert node.wait(DEADLINE) == 2
        assert "Traceback" not in node.output
        assert len(node.output.strip().splitlines()) == 1
        for word in words:
            assert word in node.output


def _bad_and_good(robot: Robot, bad: dict[str, Any], stamps: set[int]) -> None:
    """Bad states of one stamp [ns], and later a good one, whose report has the counts."""
    robot.time = round(robot.time + STEP, 9)
    stamps.add(nanoseconds_from_time(time_from_seconds(robot.time)))
    for _ in range(3):
        robot.publish(**bad)
        time.sleep(0.02)  # the queue holds one state: a later one would replace it
    robot.step()


def _more(robot: Robot, name: str, than: int) -> bool:
    return robot.count(name) > than


def _seconds(stamp: Time) -> float:
    return round(nanoseconds_from_time(stamp) * 1e-9, 9)


def _reference(robot: Robot) -> list[float]:
    return [round(value, 9) for value in robot.states[-1].tasks[0].reference]

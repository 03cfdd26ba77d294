"""What a state waits for: plans of generators, odometry of a floating base; bad ones rejected."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import ConstraintPreview, ConstraintPreviews, ControllerState
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from ghc_controller.previews.status import PreviewStatus
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.ros.qos import (
    CONTROL_PUBLISHER_QOS,
    CONTROL_SUBSCRIBER_QOS,
    PREVIEW_QOS,
    STREAM_QOS,
)
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds

DEADLINE, PATIENCE = 90.0, 0.5  # [s] wall: for what must happen, for what must not
FLOATING = """<robot name="hopper">
  <link name="body"><inertial><mass value="8"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0"
    ixz="0" iyz="0"/></inertial></link>
  <joint name="knee" type="revolute"><parent link="body"/><child link="shank"/><axis xyz="0 1 0"/>
    <origin xyz="0 0 -0.3"/><limit lower="-2" upper="2" effort="200" velocity="10"/></joint>
  <link name="shank"><inertial><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0"
    ixz="0" iyz="0"/></inertial></link>
</robot>"""


class Robot:
    """Publishes states and what belongs to them; remembers commands and counts."""

    def __init__(self, context: Any, joints: list[str], position: list[float]) -> None:
        self.node = Node("robot", context=context)
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self.node)
        self._joints, self._position = joints, position
        self.commands: list[float] = []  # [s] stamps of the states answered
        self.state = ControllerState()
        create, listen = self.node.create_publisher, self.node.create_subscription
        self._states = create(JointState, "joint_states", CONTROL_PUBLISHER_QOS)
        self._odom = create(Odometry, "odom", CONTROL_PUBLISHER_QOS)
        self._wrenches = create(WrenchStamped, "contacts/tool", CONTROL_PUBLISHER_QOS)
        self._plans = create(ConstraintPreviews, "constraints/preview", PREVIEW_QOS)
        listen(JointState, "joint_commands", self._on_command, CONTROL_SUBSCRIBER_QOS)
        listen(ControllerState, "ghc/controller_state", self._on_state, STREAM_QOS)

    def _on_command(self, message: JointState) -> None:
        assert np.isfinite(message.effort).all()
        self.commands.append(nanoseconds_from_time(message.header.stamp) * 1e-9)

    def _on_state(self, message: ControllerState) -> None:
        self.state = message

    def connected(self, topics: list[str]) -> None:
        """Wait until the controller listens."""
        counts = self.node.count_subscribers
        self.until(lambda: all(counts(topic) > 0 for topic in ["joint_states", *topics]))
        self._spin(PATIENCE)

    def publish(self, stamp: float) -> None:
        """One joint state."""
        n = len(self._joints)
        message = JointState(name=self._joints, position=self._position, velocity=[0.0] * n)
        message.effort = [0.0] * n
        message.header.stamp = time_from_seconds(stamp)
        self._states.publish(message)

    def float_at(self, stamp: float, w: float = 1.0, x: float = 0.0, speed: float = 0.0) -> None:
        """Odometry of a base at x [m], its quaternion 0, 0, 0, w."""
        message = Odometry()
        message.header.stamp = time_from_seconds(stamp)
        message.pose.pose.position.x, message.pose.pose.position.z = x, 0.6
        message.twist.twist.linear.x = speed
        message.pose.pose.orientation.w = w
        self._odom.publish(message)

    def feel(self, stamp: float, force: float) -> None:
        """A wrench at the tool, its force [N] upwards."""
        message = WrenchStamped()
        message.header.stamp = time_from_seconds(stamp)
        message.wrench.force.z = force
        self._wrenches.publish(message)

    def plan(
        self,
        stamp: float,
        *contacts: str,
        upper: float = 30.0,
        status: int = PreviewStatus.RAW.value,
    ) -> None:
        """A constant bound of each contact over two steps."""
        c = len(contacts)
        message = ConstraintPreview(kind="contact_forces", step=0.01, points=3, interpolate=True)
        message.rows = list(contacts)
        message.lower, message.upper = [0.0] * 3 * c, [upper] * 3 * c
        message.active, message.conflict = [True] * c, [False] * c
        message.status = [status] * c
        previews = ConstraintPreviews(previews=[message])
        previews.header.stamp = time_from_seconds(stamp)
        self._plans.publish(previews)

    def answered(self, stamp: float, again: Callable[[], None]) -> None:
        """The state of a stamp is answered, after `again` (repeated, since links may lose)."""
        self.until(lambda: any(abs(t - stamp) < 1e-9 for t in self.commands), again)

    def not_answered(self, stamp: float) -> None:
        """It is not, however long one waits."""
        self._spin(PATIENCE)
        assert all(abs(t - stamp) > 1e-9 for t in self.commands)

    def rejected(self, name: str) -> int:
        """How many inputs of that name were rejected."""
        counts = {entry.name: entry.count for entry in self.state.counts}
        return int(counts.get(f"rejected_{name}", 0))

    def has_rejected(self, name: str) -> bool:
        """Whether an input of that name was refused."""
        return self.rejected(name) > 0

    def _spin(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)

    def until(
        self, condition: Callable[[], bool], again: Callable[[], None] | None = None
    ) -> None:
        deadline, due = time.monotonic() + DEADLINE, 0.0
        while not condition():
            assert time.monotonic() < deadline
            if again is not None and time.monotonic() > due:
                again()
                due = time.monotonic() + 0.1
            self._executor.spin_once(timeout_sec=0.02)


def _start(start_node: Callable[..., Any], robot: Path, *parameters: str) -> Any:
    pairs = [part for text in parameters for part in ("-p", text)]
    return start_node(
        *("ghc_controller", "controller", "--ros-args", "-p", f"robot:={robot}"),
        *("-p", "state_rate:=1000.0", *pairs),
    )


def _arm(context: Any) -> Robot:
    """The robot of `arm_file`."""
    return Robot(context, [f"joint_{i}" for i in range(1, 8)], [0.1, 0.4, 0, 1, 0, -1, 0.1])


@pytest.fixture
def arm_file(tmp_path: Path) -> Path:
    """The arm with a contact at its tool."""
    source = load_robot_config(find_robot("kuka_lwr"))
    values = yaml.safe_load(source.path.read_text(encoding="utf-8"))
    contact = {"name": "tool", "frame": "tool", "points": [[0, 0, 0]], "normal": [0, 0, 1]}
    values |= {"urdf": str(source.urdf), "contacts": [contact]}
    path = tmp_path / "arm.yaml"
    path.write_text(yaml.safe_dump(values), encoding="utf-8")
    return path


@pytest.fixture
def hopper_file(tmp_path: Path) -> Path:
    """A robot whose base floats, with one joint and one contact that is on."""
    (tmp_path / "hopper.urdf").write_text(FLOATING, encoding="utf-8")
    points = [[0.1, 0.1, -0.3], [-0.1, 0.1, -0.3], [0.0, -0.1, -0.3]]
    contact = {"name": "foot", "frame": "shank", "points": points, "normal": [0, 0, 1]}
    values = {
        "name": "hopper",
        "urdf": "hopper.urdf",
        "floating_base": True,
        "tasks": [{"name": "posture", "kind": "posture", "stiffness": 30.0, "damping": 10.0}],
        "hierarchy": "posture",
        "contacts": [contact | {"active": True}],
    }
    path = tmp_path / "hopper.yaml"
    path.write_text(yaml.safe_dump(values), encoding="utf-8")
    return path


def test_a_state_waits_for_the_plan_of_its_tick(
    ros_context: Any, start_node: Callable[..., Any], arm_file: Path
) -> None:
    _start(start_node, arm_file, "wait_for_bounds:=[contact_forces]", "bounds_step:=0.01")
    robot = _arm(ros_context)
    robot.connected(["constraints/preview"])

    def both(state: float, tick: float) -> Callable[[], None]:
        def send() -> None:
            robot.publish(state)
            robot.plan(tick, "tool")

        return send

    robot.publish(0.0)
    robot.not_answered(0.0)
    robot.answered(0.0, both(0.0, 0.0))
    robot.answered(0.005, lambda: robot.publish(0.005))  # of the same tick
    robot.publish(0.01)
    robot.not_answered(0.01)
    robot.answered(0.01, both(0.01, 0.01))
    robot.until(lambda: [c.name for c in robot.state.contacts if c.planned] == ["tool"])
    assert robot.state.contacts[0].upper == 30.0


def test_of_a_plan_only_the_contact_that_the_robot_lacks_is_left_out(
    ros_context: Any, start_node: Callable[..., Any], arm_file: Path
) -> None:
    """With every plan: it is counted each time, and the log hears of it once in a while."""
    controller = _start(start_node, arm_file, "wait_for_bounds:=[contact_forces]")
    robot = _arm(ros_context)
    robot.connected(["constraints/preview"])
    field = "constraints/preview/contact_forces.left_out"
    begun = time.monotonic()
    for tick in range(20):
        stamp, upper = 0.01 * tick, 30.0 - tick

        def send(stamp: float = stamp, upper: float = upper) -> None:
            robot.plan(stamp, "heel", "tool", upper=upper)
            robot.publish(stamp)

        robot.answered(stamp, send)
    robot.until(
        lambda: [c.upper for c in robot.state.contacts] == [11.0] and robot.rejected(field) >= 20
    )
    assert [c.name for c in robot.state.contacts if c.planned] == ["tool"]
    assert robot.rejected("constraints/preview/contact_forces") == 0
    reason = f"{field}: unknown contact 'heel'; known: tool"
    assert 1 <= controller.output.count(reason) < 2.0 + time.monotonic() - begun  # one a second


def test_a_malformed_plan_is_refused_as_a_whole_and_the_node_lives(
    ros_context: Any, start_node: Callable[..., Any], arm_file: Path
) -> None:
    controller = _start(start_node, arm_file, "wait_for_bounds:=[contact_forces]")
    robot = _arm(ros_context)
    robot.connected(["constraints/preview"])

    def send(stamp: float, **fields: Any) -> Callable[[], None]:
        def both() -> None:
            robot.plan(stamp, "tool", **fields)
            robot.publish(stamp)

        return both

    robot.answered(0.0, send(0.0))
    robot.answered(0.01, send(0.01, upper=5.0, status=9))
    robot.until(lambda: robot.rejected("constraints/preview/contact_forces") > 0)
    assert [c.upper for c in robot.state.contacts] == [30.0]
    assert "status 9 given; known: 0 (SMOOTHED), 1 (RAW)" in controller.output
    robot.answered(0.02, send(0.02, upper=6.0))
    robot.until(lambda: [c.upper for c in robot.state.contacts] == [6.0])


def test_a_floating_base_needs_odometry_of_its_stamp(
    ros_context: Any, start_node: Callable[..., Any], hopper_file: Path
) -> None:
    controller = _start(start_node, hopper_file)
    robot = Robot(ros_context, ["knee"], [0.0])
    robot.connected(["odom"])

    def both(stamp: float) -> Callable[[], None]:
        def send() -> None:
            robot.float_at(stamp)
            robot.publish(stamp)

        return send

    robot.publish(0.0)
    robot.not_answered(0.0)
    robot.answered(0.0, both(0.0))
    robot.float_at(0.5)  # of another state
    robot.publish(0.001)
    robot.not_answered(0.001)
    robot.float_at(0.002, w=0.7)  # not of unit length
    robot.publish(0.002)
    robot.not_answered(0.002)
    robot.answered(0.003, both(0.003))
    robot.until(lambda: robot.rejected("odom.stamp") > 0 and robot.rejected("odom") > 0)
    assert "unit quaternion expected" in controller.output
    assert "0.001000 s" in controller.output
    for stamp, fields, field in (
        (0.004, {"x": 3.0}, "odom.pose.position"),
        (0.006, {"speed": 50.0}, "odom.twist.linear"),
    ):
        robot.float_at(stamp, **fields)
        robot.publish(stamp)
        robot.not_answered(stamp)
        robot.float_at(3600.0)  # hides nothing: companions are found by their stamps
        robot.answered(stamp + 0.001, both(stamp + 0.001))
        robot.until(partial(robot.has_rejected, field))


def test_a_wrench_that_cannot_be_costs_its_state_alone(
    ros_context: Any, start_node: Callable[..., Any], arm_file: Path
) -> None:
    controller = _start(start_node, arm_file, "wait_for_contacts:=[tool]")
    robot = _arm(ros_context)
    robot.connected(["contacts/tool"])

    def both(stamp: float, force: float = 30.0) -> Callable[[], None]:
        def send() -> None:
            robot.feel(stamp, force)
            robot.publish(stamp)

        return send

    robot.answered(0.0, both(0.0))
    for k, (force, field) in enumerate(((np.nan, "contacts/tool"), (1e6, "contacts/tool.force"))):
        stamp = 0.01 * (k + 1)
        both(stamp, force)()
        robot.not_answered(stamp)
        robot.answered(stamp + 0.005, both(stamp + 0.005, 300.0))  # an impact is no fault
        robot.until(partial(robot.has_rejected, field))
    assert "1e+06 N given" in controller.output

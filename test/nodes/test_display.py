"""The node for RViz and Foxglove over DDS: description, transforms, markers; no bridge needed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from builtin_interfaces.msg import Time
from display_client import PATIENCE, Display
from geometry_msgs.msg import WrenchStamped
from ghc_msgs.msg import ControllerState, ObstacleState, ObstacleStateArray, TaskState
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from visualization_msgs.msg import Marker

from ghc_controller.robot.library import load_robot
from ghc_sim_bridge.colors import color, rgba
from ghc_sim_bridge.ros.display.marks import Marks

StartNode = Callable[..., Any]


@pytest.fixture
def display(ros_context: Any) -> Iterator[Display]:
    made = Display(ros_context)
    yield made
    made.close()


def state_of(names: Any, q: np.ndarray) -> JointState:
    return JointState(name=list(names), position=q.tolist(), velocity=[0.0] * len(q))


def odometry_of(base: np.ndarray) -> Odometry:
    message = Odometry()
    message.header.frame_id = "3"  # an epoch: no name of a frame
    point, turn = message.pose.pose.position, message.pose.pose.orientation
    point.x, point.y, point.z, turn.x, turn.y, turn.z, turn.w = base.tolist()
    return message


def position(mark: Marker) -> list[float]:
    return [mark.pose.position.x, mark.pose.position.y, mark.pose.position.z]


def _has_said(node: Any, words: str) -> bool:
    return words in node.output


def _send_next(display: Display, message: JointState, clock: Iterator[float]) -> None:
    display.send("joint_states", message, next(clock))


def start(start_node: StartNode, *parameters: str) -> Any:
    pairs = [part for text in parameters for part in ("-p", text)]
    return start_node("ghc_sim_bridge", "display_publisher", "--ros-args", *pairs)


@pytest.mark.parametrize("name", ["kuka_lwr", "icub"])
def test_transforms_are_those_of_pinocchio(
    start_node: StartNode, display: Display, name: str
) -> None:
    node = start(start_node, f"robot:={name}")
    robot = load_robot(name)
    root = (pin.JointModelFreeFlyer(),) if robot.floating_base else ()
    model = pin.buildModelFromUrdf(str(robot.urdf), *root)
    data = model.createData()
    random = np.random.default_rng(3)
    for k in range(1, 4):
        q = random.uniform(-1.0, 1.0, model.nq)
        base = np.array([0.3, -0.2, 0.6, *random.normal(size=4)])
        base[3:] /= np.linalg.norm(base[3:])
        joints = q[7:] if robot.floating_base else q
        if robot.floating_base:
            q[:7] = base

        def send(k: int = k, joints: np.ndarray = joints, base: np.ndarray = base) -> None:
            if robot.floating_base:
                display.send("odom", odometry_of(base), float(k))
            names = list(robot.model.joint_names)
            display.send("joint_states", state_of(names[::-1], joints[::-1]), float(k))

        def come(k: int = k) -> bool:
            stamps = {stamp for _, _, stamp in display.transforms.values()}
            return stamps == {0, k * 1_000_000_000}

        display.until(come, send)
        pin.framesForwardKinematics(model, data, q)
        for frame in robot.model.frame_names:
            expected = data.oMf[model.getFrameId(frame, pin.FrameType.BODY)]
            off = np.abs(display.place(frame).homogeneous - expected.homogeneous).max()
            assert off < 1e-9, f"{frame}: {off}"
    display.until(lambda: display.descriptions)  # latched
    drawn = pin.buildModelFromXML(display.descriptions[-1], *root)
    assert list(drawn.names) == list(model.names)
    assert node.stop() == 0
    assert "Traceback" not in node.output


def test_markers_are_at_the_targets_contacts_and_obstacles(
    start_node: StartNode, display: Display
) -> None:
    node = start(start_node, "scene:=kuka_lwr_plane", "force_scale:=0.01")
    robot = load_robot("kuka_lwr")
    q = np.array([0.1, 0.5, -0.2, 1.0, 0.3, -0.7, 0.2])
    robot.model.update(q, np.zeros(7))
    tool = robot.model.frame_position(robot.model.frame_id("tool"))
    target = np.array([0.5, 0.1, 0.7])
    report = ControllerState(alpha=[0.0, 1.0, 0.0, 1.0])
    report.tasks = [
        TaskState(name="end_effector", reference=target.tolist(), error=[0.1] * 3),
        TaskState(name="elbow", reference=[0.0, 0.2, 0.6], error=[0.1] * 3),
    ]
    wrench = WrenchStamped()
    wrench.wrench.force.z = 20.0
    obstacle = ObstacleState(id="box", protected_frame="tool", safe_distance=0.1)
    obstacle.position[:], obstacle.normal[:] = (0.6, 0.0, 0.5), (-1.0, 0.0, 0.0)

    def send(seconds: float, all_of_it: bool) -> None:
        if all_of_it:
            display.send("ghc/controller_state", report, seconds)
            display.send("contacts/tool", wrench, seconds)
            display.send(
                "constraints/obstacles", ObstacleStateArray(obstacles=[obstacle]), seconds
            )
        display.send("joint_states", state_of(robot.model.joint_names, q), seconds)

    clock = iter(np.arange(1.0, 100.0, 0.01))
    groups = ("targets", "forces", "obstacles", "surroundings")
    display.until(
        lambda: all(display.marks(group) for group in groups), lambda: send(next(clock), True)
    )
    first, second = display.marks("targets")
    assert position(first) == pytest.approx(target, abs=1e-12)
    assert position(second) == pytest.approx([0.0, 0.2, 0.6], abs=1e-12)
    inks = [(m.color.r, m.color.g, m.color.b, m.color.a) for m in (first, second)]
    assert inks[0] == pytest.approx(rgba(color(0)), abs=1e-6)
    assert inks[1] == pytest.approx(rgba(color(1), 0.25), abs=1e-6)  # removed: faint
    (error, _) = display.marks("errors")
    ends = [[end.x, end.y, end.z] for end in error.points]
    assert ends == [pytest.approx(target), pytest.approx(tool, abs=1e-9)]
    (force,) = display.marks("forces")
    (contact,) = display.marks("contacts")
    begin, end = ([p.x, p.y, p.z] for p in force.points)
    assert begin == pytest.approx(position(contact), abs=1e-12)
    assert end == pytest.approx(np.array(begin) + [0.0, 0.0, 0.2], abs=1e-12)
    (ball,) = display.marks("obstacles")
    assert position(ball) == pytest.approx([0.6, 0.0, 0.5])
    (safe,) = display.marks("obstacles: safe distance")
    assert safe.scale.x == pytest.approx(0.2)
    assert {mark.header.frame_id for mark in display.arrays[-1].markers} == {"world"}
    # What is not measured any more goes; targets stay.
    seen = len(display.arrays)
    display.until(
        lambda: len(display.arrays) > seen and not display.marks("forces"),
        lambda: send(200.0 + next(clock), False),
    )
    removed = {
        mark.ns
        for array in display.arrays[seen:]
        for mark in array.markers
        if mark.action == Marker.DELETE
    }
    assert {"forces", "obstacles"} <= removed
    assert display.marks("targets")
    assert node.stop() == 0


def test_a_fast_robot_is_shown_at_the_pace_of_a_screen(
    start_node: StartNode, display: Display
) -> None:
    start(start_node, "robot:=kuka_lwr", "rate:=20.0")
    names = load_robot("kuka_lwr").model.joint_names
    stamps = iter(range(1, 100_000))

    def send() -> None:
        display.send("joint_states", state_of(names, np.zeros(7)), next(stamps) * 1e-3)

    display.until(lambda: display.count > 1, send)
    display.spin(0.3)  # what was on its way comes
    display.count, begin = 0, time.monotonic()
    while display.count <= 5 or time.monotonic() < begin + 2.0:
        assert time.monotonic() < begin + PATIENCE
        send()
        display.spin(0.002)
    assert display.count <= 20 * (time.monotonic() - begin) + 2


def test_bad_states_are_named_and_the_node_lives(start_node: StartNode, display: Display) -> None:
    node = start(start_node, "robot:=kuka_lwr")
    node.wait_for_output("ready")
    names = load_robot("kuka_lwr").model.joint_names
    q = np.zeros(7)
    clock = iter(np.arange(1.0, 100.0, 0.01))
    nan = np.array([np.nan, *q[1:]])
    for message, words in (
        (state_of(names, nan), "not a finite number at joint 'joint_1'"),
        (state_of(names, q[1:]), "6 entries given, 7 expected"),
        (state_of(names[:5], q[:5]), "joint_6, joint_7 missing: no markers"),
    ):
        display.until(
            partial(_has_said, node, words), partial(_send_next, display, message, clock)
        )
    display.until(
        lambda: display.arrays,
        lambda: display.send("joint_states", state_of(names, q), next(clock)),
    )
    assert node.stop() == 0


def test_a_namespace_goes_in_front_of_topics_and_links(
    start_node: StartNode, ros_context: Any
) -> None:
    display = Display(ros_context, "left")
    node = start_node(
        "ghc_sim_bridge", "display_publisher", "--ros-args", "-p", "robot:=kuka_lwr",
        "-r", "__ns:=/left",
    )  # fmt: skip
    names = load_robot("kuka_lwr").model.joint_names
    clock = iter(np.arange(1.0, 100.0, 0.01))
    display.until(
        lambda: display.descriptions and display.arrays and "left/tool" in display.transforms,
        lambda: display.send("joint_states", state_of(names, np.zeros(7)), next(clock)),
    )
    assert all(child.startswith("left/") for child in display.transforms)
    assert {parent for parent, _, _ in display.transforms.values() if "/" not in parent} == {
        "world"
    }
    assert node.stop() == 0
    display.close()


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ((), ["'robot'", "a 'scene'"]),
        (("robot:=no_such_robot",), ["unknown robot 'no_such_robot'"]),
        (("robot:=kuka_lwr", "rate:=0.0"), ["'rate'", "in (0, 100]"]),
        (("robot:=kuka_lwr", "description:=no_such.urdf"), ["no_such.urdf", "cannot be read"]),
        (("robot:=kuka_lwr", "robt:=x"), ["robt"]),
    ],
)
def test_what_cannot_be_used_is_one_clear_line(
    start_node: StartNode, parameters: tuple[str, ...], words: list[str]
) -> None:
    node = start(start_node, *parameters)
    assert node.wait() == 2
    (line,) = node.output.strip().splitlines()
    assert all(word in line for word in ["display_publisher: ", *words]), line


def test_names_that_come_and_go_are_deleted_and_forgotten() -> None:
    """As of a tracker that numbers what it sees."""
    marks, shown = Marks("world"), set[int]()
    for k in range(30):
        marks.begin(Time())
        for name in (f"ball {k}", f"ball {k + 1}"):
            marks.sphere("obstacles", name, np.zeros(3), 0.1, rgba(color(0)))
        sent = marks.message().markers
        shown -= {mark.id for mark in sent if mark.action == Marker.DELETE}
        shown |= {mark.id for mark in sent if mark.action == Marker.ADD}
        assert len(shown) == len(marks._ids) == 2

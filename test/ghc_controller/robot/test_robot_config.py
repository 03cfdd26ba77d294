"""robot.yaml: what it gives, and one clear line for each mistake."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import Robot, load_robot_config
from ghc_controller.tasks.frame import FramePositionTask

URDF = """<robot name="two"><link name="base"/>
<link name="upper"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hip" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="2" effort="3"/></joint>
<joint name="knee" type="revolute"><origin xyz="0.1 0 0"/><parent link="upper"/>
<child link="lower"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="2" effort="3"/>
</joint></robot>"""

GAINS = {"stiffness": 30.0, "damping": 20.0}
FOOT = {"name": "foot", "kind": "frame_position", "frame": "lower"} | GAINS
POSTURE = {"name": "rest", "kind": "posture"} | GAINS
FORCE = {"axes": ["z"], "contact": "sole", "threshold": 1.0}


def _load(folder: Path, **changes: Any) -> Robot:
    """A good robot.yaml with `changes` (None removes a field), loaded."""
    content: dict[str, Any] = {
        "name": "two",
        "urdf": "two.urdf",
        "tasks": [FOOT, POSTURE],
        "hierarchy": "foot > rest",
    }
    content = {key: value for key, value in (content | changes).items() if value is not None}
    (folder / "two.urdf").write_text(URDF)
    path = folder / "robot.yaml"
    path.write_text(yaml.safe_dump(content))
    return load_robot_config(path)


def test_the_lwr_of_the_package_loads() -> None:
    """The tasks of the paper under their names."""
    config = load_robot_config(find_robot("kuka_lwr"))
    assert config.name == "kuka_lwr"
    assert set(config.task_names) == {"end_effector", "elbow", "posture"}
    assert config.torque_rate == 1000.0
    assert config.model.joint_names == tuple(f"joint_{i}" for i in range(1, 8))


def test_every_field_arrives(tmp_path: Path) -> None:
    """Limits as a number and as a map, gains per axis, references, force rows."""
    config = _load(
        tmp_path,
        limits={
            "velocity": 1.5,
            "torque": {"knee": 2.0},
            "torque_rate": 500,
            "brake_acceleration": 4,
        },
        tasks=[
            FOOT
            | {"axes": ["x", "z"], "stiffness": [1, 2], "reference": [0.1, 0.2], "force": FORCE},
            POSTURE | {"reference": {"knee": 0.3}},
            {"name": "turn", "kind": "frame_orientation", "frame": "lower"} | GAINS,
            {"name": "pose", "kind": "frame_pose", "frame": "upper"} | GAINS,
            {"name": "balance", "kind": "center_of_mass", "axes": ["x"]} | GAINS,
        ],
    )
    model = config.model
    assert model.velocity_limit.tolist() == [1.5, 1.5]
    assert model.torque_limit.tolist() == [3.0, 2.0]
    assert (config.torque_rate, config.brake_acceleration) == (500.0, 4.0)
    foot, rest, turn, pose, balance = config.tasks
    assert isinstance(foot, FramePositionTask)
    assert foot.labels == ("x", "z")
    assert foot.stiffness.tolist() == [1.0, 2.0]
    assert foot.default_target(model).position.tolist() == [0.1, 0.2]
    assert foot.force is not None
    assert foot.force.release == 0.2
    assert foot.force_row_mask.tolist() == [False, True]
    assert rest.labels == ("knee",)
    assert rest.default_target(model).position.tolist() == [0.3]
    assert (turn.size, pose.size, balance.size) == (3, 6, 1)


def test_a_task_without_a_reference_stays_where_it_is(tmp_path: Path) -> None:
    """The default target is the present, at the last update of the model."""
    config = _load(tmp_path)
    config.model.update(np.array([0.5, 0.1]), np.zeros(2))
    assert config.tasks[1].default_target(config.model).position.tolist() == [0.5, 0.1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": None}, "name: missing; given: hierarchy, tasks, urdf"),
        ({"urdf": "gone.urdf"}, "gone.urdf: robot model does not exist"),
        ({"floating_base": "no"}, "floating_base: true or false expected, 'no' given"),
        ({"colour": "red"}, "colour: unknown field; known: name, urdf, floating_base, limits"),
        ({"tasks": []}, "tasks: at least one entry expected, none given"),
        ({"tasks": [FOOT, FOOT]}, "tasks[1].name: 'foot' is already taken by another task"),
        ({"tasks": ["foot"]}, "tasks[0]: a mapping expected, 'foot' given"),
        (
            {"tasks": [FOOT | {"kind": "dance"}]},
            "tasks[0].kind: 'dance' given; known: center_of_mass, frame_avoidance",
        ),
        (
            {"tasks": [FOOT | {"frame": "hand"}]},
            "tasks[0].frame: 'hand' given; known: base, upper, lower",
        ),
        (
            {"tasks": [FOOT | {"axes": ["x", "w"]}]},
            "tasks[0].axes: 'w' given; known: x, y, z",
        ),
        ({"tasks": [FOOT | {"axes": ["x", "x"]}]}, "tasks[0].axes: names must differ"),
        (
            {"tasks": [FOOT | {"stiffness": "high"}]},
            "tasks[0].stiffness: 3 numbers expected, 'high' given",
        ),
        (
            {"tasks": [FOOT | {"stiffness": [1.0, 2.0]}]},
            "tasks[0].stiffness: 3 numbers expected, 2 given: [1.0, 2.0]",
        ),
        (
            {"tasks": [FOOT | {"stiffness": [1.0, "high", 2.0]}]},
            "tasks[0].stiffness[1]: a number expected, 'high' given",
        ),
        (
            {"tasks": [FOOT | {"stiffness": -1.0}]},
            "tasks[0]: task 'foot', stiffness: [-1.0, -1.0, -1.0] given, numbers >= 0 expected",
        ),
        (
            {"tasks": [FOOT | {"stifness": 1.0}]},
            "tasks[0].stifness: unknown field; known: kind, ",
        ),
        (
            {"tasks": [FOOT | {"force": FORCE | {"axes": ["u"]}}]},
            "tasks[0].force.axes: 'u' given; known: x, y, z",
        ),
        (
            {"tasks": [FOOT | {"force": FORCE | {"release": 2.0}}]},
            "tasks[0].force.release: 2.0 given, at most threshold 1.0 expected",
        ),
        (
            {"tasks": [POSTURE | {"reference": {"ankle": 1.0}}]},
            "tasks[0].reference.ankle: unknown joint; known: hip, knee",
        ),
        (
            {"tasks": [POSTURE | {"reference": {"hip": 1.0}, "joints": ["knee"]}]},
            "tasks[0].reference: joint 'knee' missing",
        ),
        (
            {"limits": {"velocity": {"ankle": 1.0}}},
            "limits.velocity: unknown joint 'ankle'; known: hip, knee",
        ),
        (
            {"limits": {"torque": -2.0}},
            "limits.torque: torque of 'hip': -2.0 given, a positive number expected",
        ),
        ({"limits": {"torque": "much"}}, "limits.torque: a number or a mapping name: number"),
        ({"limits": {"torque": {"knee": None}}}, "limits.torque.knee: it has no value: leave"),
        (
            {"limits": {"torque_rate": np.inf}},
            "limits.torque_rate: a number or a mapping name: number expected, inf given",
        ),
        ({"limits": {"torque_rate": 0}}, "limits.torque_rate: torque_rate of 'hip': 0.0 given"),
        ({"limits": {"jerk": 1.0}}, "limits.jerk: unknown field; known: velocity, torque, "),
        ({"hierarchy": None}, "hierarchy: missing; given: name, tasks, urdf"),
    ],
)
def test_a_mistake_gives_one_line_with_file_field_given_and_expected(
    tmp_path: Path, changes: dict[str, Any], message: str
) -> None:
    """Each mistake alone, in an otherwise good file."""
    with pytest.raises(ConfigurationError) as caught:
        _load(tmp_path, **changes)
    text = str(caught.value)
    assert text.startswith(str(tmp_path))
    assert message in text
    assert "\n" not in text


def test_a_file_that_is_missing_or_no_yaml(tmp_path: Path) -> None:
    """Names the file."""
    with pytest.raises(ConfigurationError, match=r"robot\.yaml: cannot be read: No such file"):
        load_robot_config(tmp_path / "robot.yaml")
    path = tmp_path / "bad.yaml"
    path.write_text("tasks: [")
    with pytest.raises(ConfigurationError, match=r"bad\.yaml: not valid YAML: while parsing"):
        load_robot_config(path)
    path.write_bytes(b"name: \xff")
    with pytest.raises(ConfigurationError, match=r"bad\.yaml: not valid YAML: .*utf-8"):
        load_robot_config(path)
    path.write_text("- a\n- b\n")
    with pytest.raises(ConfigurationError, match=r"bad\.yaml: a mapping expected"):
        load_robot_config(path)


@pytest.mark.parametrize(
    "value",
    [
        "[" * 200_000,
        "- " * 200_000,
        "{a: " * 101,
        "9" * 5000,
        "2001-99-99",
        "!!int x",
        "!!bool x",
        "!!float ''",
        "!!timestamp x",
    ],
    ids=lambda value: value[:12],
)
def test_what_the_loader_cannot_take_is_no_yaml(value: str, tmp_path: Path) -> None:
    """Too deep for its stack, or a tag that its value does not have."""
    path = tmp_path / "bad.yaml"
    path.write_text(f"name: arm\nurdf:\n  {value}\n", encoding="utf-8")
    with pytest.raises(ConfigurationError, match=r"bad\.yaml: not valid YAML: "):
        load_robot_config(path)


@pytest.mark.parametrize("field", ["axes", "reference", "force"])
def test_an_optional_field_without_a_value_is_refused(tmp_path: Path, field: str) -> None:
    """Whoever writes `force:` and no more means something by it."""
    with pytest.raises(ConfigurationError, match=rf"tasks\[0\].{field}: it has no value"):
        _load(tmp_path, tasks=[FOOT | {field: None}, POSTURE])


def test_limits_that_the_urdf_lacks_are_asked_for(tmp_path: Path) -> None:
    """An effort of zero is no limit that a controller can work with."""
    _load(tmp_path)
    (tmp_path / "two.urdf").write_text(URDF.replace('effort="3"', 'effort="0"'))
    with pytest.raises(
        ConfigurationError, match=r"limits.torque: the URDF gives 0 for joint 'hip'"
    ):
        load_robot_config(tmp_path / "robot.yaml")


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        (30.0, "30 for joint 'joint_1' is beyond its limits"),
        ({}, "reference: at least one joint expected, none given"),
    ],
)
def test_a_posture_in_degrees_or_without_joints_is_refused(
    tmp_path: Path, reference: object, message: str
) -> None:
    """Beyond a position limit: joint, value and limits are named."""
    source = find_robot("kuka_lwr")
    values = yaml.safe_load(source.read_text(encoding="utf-8"))
    values["urdf"] = str(source.parent / values["urdf"])
    values["tasks"][-1]["reference"] = reference
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(values), encoding="utf-8")
    with pytest.raises(ConfigurationError, match=message):
        load_robot_config(tmp_path / "robot.yaml")


def test_torque_rate_by_joint(tmp_path: Path) -> None:
    """Joints that the map leaves out keep the default; names and signs are checked."""
    config = _load(tmp_path, limits={"torque_rate": {"knee": 200.0}})
    rates = dict(zip(config.model.joint_names, np.array(config.torque_rate), strict=True))
    assert rates.pop("knee") == 200.0
    assert set(rates.values()) == {1000.0}
    for given, text in (({"knee": 0.0}, "a positive number expected"), ({"elbow": 5.0}, "elbow")):
        with pytest.raises(ConfigurationError, match=text):
            _load(tmp_path, limits={"torque_rate": given})

"""A scene file is checked with file and field in the message; what it says ends up in MuJoCo."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from robot_scenes import FIXED_SCENES

from ghc_controller.errors import ConfigurationError, GhcError, UnknownName
from ghc_controller.migration.names import RENAMED, Kind, Renamed
from ghc_controller.robot.library import load_robot
from ghc_sim_bridge.scene.description import find_scene, list_scenes, load_scene
from ghc_sim_bridge.simulation.mujoco_model import build_model
from ghc_sim_bridge.simulation.simulator import Simulator

SCENE = """
robot: kuka_lwr
start: {joint_1: 0.1}
surfaces: [{name: ground, kind: plane, top: [0, 0, -0.5]}]
contacts: [{name: tool, radius: 0.03, inward: [0, 0, -1]}]
camera: {look_at: [0, 0, 0.5], distance: 2, azimuth: 120, elevation: -20}
"""


TOOL = "{name: tool, frame: tool, points: [[0, 0, 0]], normal: [0, 0, 1]}"


def robot_file(folder: Path, more: str = "floating_base: false") -> None:
    """The arm with one task, in a robot.yaml of its own."""
    (folder / "arm.urdf").write_bytes(load_robot("kuka_lwr").urdf.read_bytes())
    task = "{name: posture, kind: posture, stiffness: 30, damping: 20}"
    (folder / "robot.yaml").write_text(
        f"{{name: arm, urdf: arm.urdf, tasks: [{task}], hierarchy: posture, {more}}}", "utf-8"
    )


def scene_file(folder: Path, text: str = SCENE) -> Path:
    file = folder / "scene.yaml"
    file.write_text(text, encoding="utf-8")
    return file


def test_scenes_are_found_by_name_and_by_path() -> None:
    assert {"kuka_lwr", "kuka_lwr_plane"} <= set(list_scenes())
    file = find_scene("kuka_lwr")
    assert find_scene(file) == find_scene(str(file)) == file


@pytest.mark.parametrize("name", FIXED_SCENES)
def test_every_scene_starts_inside_the_joint_limits_and_above_its_surfaces(name: str) -> None:
    simulator = Simulator(name)
    lower, upper = simulator.position_limits.T
    assert (simulator.start > lower + 0.1).all() and (simulator.start < upper - 0.1).all()
    simulator.step(simulator.hold_torque())
    for wrench in simulator.contact_wrenches().values():
        assert np.array_equal(wrench, np.zeros(6))


def test_a_scene_file_of_the_user_is_read_as_it_stands(tmp_path: Path) -> None:
    simulator = Simulator(scene_file(tmp_path))
    assert simulator.start.tolist() == [0.1, 0, 0, 0, 0, 0, 0]
    assert list(simulator.contact_wrenches()) == ["tool"]
    assert simulator.model.opt.gravity.tolist() == [0.0, 0.0, -9.81]
    assert simulator.model.geom("contact/tool/0").size[0] == 0.03


def test_balls_touch_at_the_points_of_the_robot_file_or_are_around_them() -> None:
    simulator = Simulator("icub_table")
    robot, model = simulator.scene.robot, simulator.model
    for contact in simulator.scene.contacts:
        place = robot.contact_places[contact.name]
        assert contact.frame == place.frame
        inward = np.zeros(3) if contact.inward is None else np.array(contact.inward)
        site = model.site(place.frame)
        for k, point in enumerate(place.points):
            ball = model.geom(f"contact/{contact.name}/{k}")
            turned = np.zeros(9)
            mujoco.mju_quat2Mat(turned, site.quat)
            center = site.pos + turned.reshape(3, 3) @ (point + contact.radius * inward)
            np.testing.assert_allclose(ball.pos, center, rtol=0.0, atol=1e-12)


def test_limits_are_those_of_the_robot() -> None:
    for name in ("kuka_lwr", "icub_standing"):
        simulator = Simulator(name)
        model = simulator.scene.robot.model
        order = [model.joint_index(joint) for joint in simulator.joint_names]
        assert np.array_equal(simulator.torque_limit, model.torque_limit[order])
        assert np.array_equal(simulator.velocity_limit, model.velocity_limit[order])
        assert np.array_equal(simulator.position_limits.T[0], model.position_lower[order])


def test_nothing_of_the_scene_changes_the_robots_masses(tmp_path: Path) -> None:
    plain = build_model(load_scene("kuka_lwr"), 1e-3)
    dressed = build_model(load_scene(scene_file(tmp_path)), 1e-3)
    assert np.array_equal(plain.body_mass, dressed.body_mass)
    assert np.array_equal(plain.body_inertia, dressed.body_inertia)
    assert not plain.dof_damping.any() and not plain.dof_armature.any()
    assert not plain.dof_frictionloss.any()


def test_the_robot_does_not_touch_itself() -> None:
    """Folded onto itself, the arm has no contact: shapes are for the eye."""
    simulator = Simulator("kuka_lwr")
    simulator.reset([0.0, 2.0, 0.0, -2.0, 0.0, 2.0, 0.0])
    assert simulator.data.ncon == 0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("robot: kuka_lwr", "robot: kuka", "scene.yaml: robot: unknown robot 'kuka'; known: "),
        ("robot: kuka_lwr", "", "scene.yaml: robot: missing; given: "),
        ("joint_1: 0.1", "joint_1: high", r"start.joint_1: a number expected, 'high' given"),
        ("kind: plane", "kind: sphere", r"surfaces\[0\].kind: 'sphere' given; known: plane, box"),
        ("[0, 0, -0.5]", "[0, 0]", r"surfaces\[0\].top: 3 numbers expected, 2 given"),
        ("kind: plane,", "kind: plane, touches: 1,", r"surfaces\[0\].touches: true or false"),
        ("kind: plane,", "kind: box,", r"surfaces\[0\].size: missing; given: "),
        ("kind: plane,", "kind: box, size: [1, 1, 0],", r"surfaces\[0\].size: lengths above 0"),
        ("kind: plane,", "kind: plane, hieght: 1,", r"surfaces\[0\].hieght: unknown field"),
        ("radius: 0.03", "radius: -1", r"contacts\[0\].radius: a number >= 0.0001 expected, -1"),
        ("[0, 0, -1]", "[0, 0, -2]", r"contacts\[0\].inward: length 1 expected, 2 given"),
        ("name: tool", "name: tip", r"contacts\[0\].name: 'tip' given, .*known: tool"),
        ("distance: 2,", "", "camera.distance: missing; given: "),
        ("surfaces:", "surface:", "surface: unknown field; known: .*surfaces"),
    ],
)
def test_what_cannot_be_used_is_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in SCENE
    with pytest.raises(ConfigurationError, match=message) as error:
        load_scene(scene_file(tmp_path, SCENE.replace(old, new)))
    assert str(error.value).count("\n") == 0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("joint_1", "joint_9", "unknown joint in 'start' of .*'joint_9'; known: joint_1"),
    ],
)
def test_names_that_the_robot_does_not_have_are_named(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    with pytest.raises(UnknownName, match=message):
        Simulator(scene_file(tmp_path, SCENE.replace(old, new)))


@pytest.mark.parametrize("row", [row for row in RENAMED if row.kind is Kind.SCENE])
def test_what_the_robot_file_says_now_is_named(tmp_path: Path, row: Renamed) -> None:
    field = row.old.removeprefix("contacts.")
    text = SCENE.replace("radius:", f"{field}: tool, radius:")
    with pytest.raises(ConfigurationError, match=rf"contacts\[0\].{field}: it is '{row.new}' now"):
        load_scene(scene_file(tmp_path, text))


def test_an_unknown_scene_is_refused_with_the_ones_that_exist(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match=r"unknown scene 'moon'; known: .*kuka_lwr, "):
        load_scene("moon")
    with pytest.raises(ConfigurationError, match=r"moon.yaml' does not exist.*kuka_lwr"):
        load_scene(tmp_path / "moon.yaml")


@pytest.mark.parametrize(
    ("floating", "base", "message"),
    [
        ("true", "", "scene.yaml: base: missing; given: "),
        ("maybe", "", "robot.yaml: floating_base: true or false expected, 'maybe' given"),
        ("false", "base: {stand_on: [foot]}", "scene.yaml: base: the robot's base is fixed"),
        ("true", "base: {stand_on: []}", "base.stand_on: a list of frames expected"),
        (
            "true",
            "base: {stand_on: [foot], yaw: 1}",
            "base.yaw: unknown field; known: stand_on, at",
        ),
    ],
)
def test_where_a_base_starts_is_given_for_a_floating_one_only(
    tmp_path: Path, floating: str, base: str, message: str
) -> None:
    robot_file(tmp_path, f"floating_base: {floating}, contacts: [{TOOL}]")
    text = SCENE.replace("robot: kuka_lwr", "robot: ./robot.yaml") + base
    with pytest.raises(ConfigurationError, match=message):
        load_scene(scene_file(tmp_path, text))


@pytest.mark.parametrize(
    ("urdf", "message"),
    [
        (None, "arm.urdf: robot model does not exist"),
        ("no xml at all", "not a URDF"),
        ("<robot name='arm'><link name='a'/><joint/></robot>", "arm.urdf: .*"),
    ],
)
def test_a_urdf_that_cannot_be_used_is_named(
    tmp_path: Path, urdf: str | None, message: str
) -> None:
    robot_file(tmp_path)
    (tmp_path / "arm.urdf").unlink()
    if urdf is not None:
        (tmp_path / "arm.urdf").write_text(urdf, encoding="utf-8")
    file = scene_file(tmp_path, SCENE.replace("robot: kuka_lwr", "robot: ./robot.yaml"))
    with pytest.raises(GhcError, match=message) as error:
        Simulator(file)
    assert "\n" not in str(error.value)


def test_a_scene_may_have_motors_without_limits_and_joints_without_end_stops() -> None:
    """The fencer's: a joint pushed beyond its limit turns on, with no torque from a stop."""
    scene = load_scene("icub_fencer")
    simulator = Simulator(scene)
    assert (simulator.torque_limit == 1e5).all()
    assert not scene.end_stops
    q = simulator.start.copy()
    q[0] = simulator.position_limits[0, 1] + 0.1
    simulator.reset(q)
    wanted = np.full(simulator.nv, 2.0)
    simulator.step(simulator.mass_matrix() @ wanted + simulator.bias())
    assert np.abs(simulator.acceleration - wanted).max() < 1e-7
    assert load_scene("kuka_lwr").end_stops


def test_a_start_in_degrees_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        ConfigurationError, match=r"start\.joint_1: 20 is beyond the joint's limits"
    ):
        Simulator(scene_file(tmp_path, SCENE.replace("joint_1: 0.1", "joint_1: 20.0")))

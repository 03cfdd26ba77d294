"""A robot in MJCF: both engines have the dynamics of its own model, and it swaps priorities."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.errors import ConfigurationError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.first_files.new_robot import write_first_files
from ghc_controller.robot.urdf import find_urdf
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.check_robot import find_faults
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.urdf_for_mujoco import for_mujoco

MODEL = Path(__file__).resolve().parents[2] / "models" / "seven_axis.xml"
AGREE = 1e-8  # [kg m^2], [Nm], [m]
HOLD = 6.0  # [s]
AT_REST = 1e-3  # [rad/s] mean over joints and the last second


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `new_robot` writes for the arm."""
    made = tmp_path_factory.mktemp("mjcf") / "seven_axis"
    write_first_files(MODEL, made, "seven_axis")
    return made


class Source:
    """The arm as MuJoCo compiles the MJCF itself, without what a URDF cannot say."""

    def __init__(self, names: tuple[str, ...]) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(MODEL))
        self.model.dof_damping[:] = 0.0
        self.data = mujoco.MjData(self.model)
        self._at = [self.model.joint(name).id for name in names]  # one coordinate each

    def dynamics(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """M and h of the joints; the others are held at zero."""
        self.data.qpos[:] = self.data.qvel[:] = 0.0
        self.data.qpos[self._at], self.data.qvel[self._at] = q, v
        mujoco.mj_forward(self.model, self.data)
        mass = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, mass)
        return mass[np.ix_(self._at, self._at)], self.data.qfrc_bias[self._at]


def test_both_engines_have_the_dynamics_of_the_mjcf(folder: Path) -> None:
    rng = np.random.default_rng(5)
    simulator = Simulator(folder / "scene.yaml")
    model = ghc.load_robot(folder).model
    assert simulator.joint_names == model.joint_names
    source = Source(model.joint_names)
    for _ in range(20):
        q = rng.uniform(0.9 * model.position_lower, 0.9 * model.position_upper)
        v = rng.uniform(-1.0, 1.0, model.nv)
        mass, bias = source.dynamics(q, v)
        ours = model.update(q, v)
        simulator.reset(q, v)
        for other in (ours, simulator.dynamics()):
            np.testing.assert_allclose(other.mass_matrix, mass, rtol=0.0, atol=AGREE)
            np.testing.assert_allclose(other.bias, bias, rtol=0.0, atol=AGREE)
        for frame in ("tool", "hand", "upper_arm"):
            kind = source.data.site if frame == "tool" else source.data.body
            place = kind(frame).xpos
            position = model.frame_position(model.frame_id(frame))
            np.testing.assert_allclose(position, place, rtol=0.0, atol=AGREE)
            np.testing.assert_allclose(
                simulator.frame_position(frame), place, rtol=0.0, atol=AGREE
            )


def test_limits_are_those_of_ranges_and_motors() -> None:
    model = RobotModel.from_urdf(find_urdf(str(MODEL), MODEL))
    assert model.joint_names[:2] == ("base_yaw", "shoulder")
    assert "right_finger" not in model.joint_names, "it follows the other one, and is held"
    assert np.array_equal(model.torque_limit, [80, 80, 60, 60, 15, 15, 15, 20])
    assert model.position_upper[3] == pytest.approx(np.deg2rad(140.0))


def test_new_robot_and_a_swap_of_priorities(folder: Path) -> None:
    """Defaults, rate limit on; the first task is met and the arm is at rest after each phase."""
    robot = ghc.load_robot(folder)
    assert list(find_faults(robot, load_scene(folder / "scene.yaml"))) == []
    simulator = Simulator(folder / "scene.yaml", joint_names=robot.model.joint_names)
    controller = ghc.Controller(robot)
    controller.start(simulator.state())
    scenario = (folder / "swap.yaml").read_text(encoding="utf-8")
    for name in ("end_effector", "elbow"):
        line = next(line for line in scenario.splitlines() if line.startswith(f"  {name}:"))
        target = line.partition("[")[2].partition("]")[0]
        controller.set_reference(name, [float(number) for number in target.split(",")])
    orders = ("end_effector > elbow > posture", "elbow > end_effector > posture")
    for phase, order in enumerate((*orders, orders[0])):
        if phase:
            controller.change_hierarchy(order, duration=2.0)
        end = simulator.time + 2.0 + HOLD
        speeds = []
        while simulator.time < end - 1e-9:
            state = simulator.state()
            simulator.step(controller.step(state).torque)
            if simulator.time > end - 1.0:
                speeds.append(np.abs(state.v).mean())
        first = controller.report().errors[order.partition(" ")[0]]
        assert np.linalg.norm(first) <= 1e-3, order
        assert np.mean(speeds) <= AT_REST, order


def test_a_base_that_floats(tmp_path: Path) -> None:
    """A free joint: the floating base of robot.yaml; what stands in the world is no part of it."""
    file = tmp_path / "walker.xml"
    file.write_text(
        """<?xml version="1.0"?>
        <!-- a torso with one leg -->
        <mujoco><worldbody><geom type="plane" size="1 1 1"/>
          <body name="table" pos="3 0 0"><geom type="box" size="1 1 1"/></body>
          <body name="torso" pos="0 0 1"><freejoint/><geom type="box" size=".1 .2 .3"/>
            <body name="leg" pos="0 0 -.3"><joint name="hip" axis="0 1 0" range="-60 60"/>
              <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".05"/></body></body>
        </worldbody></mujoco>""",
        encoding="utf-8",
    )
    model = RobotModel.from_urdf(find_urdf(str(file), file), floating_base=True)
    assert model.joint_names == ("hip",) and model.frame_names == ("torso", "leg")
    source = mujoco.MjModel.from_xml_path(str(file))
    assert model.mass == pytest.approx(source.body_subtreemass[source.body("torso").id])


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (
            '<body name="a"><joint type="ball"/><geom size="1"/></body>',
            "a hinge or a slide expected",
        ),
        (
            '<body name="a"><freejoint/><geom size="1"/></body>'
            '<body name="b"><freejoint/><geom size="1"/></body>',
            "one free body at most expected, a, b given",
        ),
        ('<body name="a"><joint/></body>', "MuJoCo rejects it: "),
    ],
)
def test_what_cannot_be_converted_is_named(tmp_path: Path, body: str, words: str) -> None:
    file = tmp_path / "robot.xml"
    file.write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(ConfigurationError, match=f"robot.xml: .*{words}"):
        find_urdf(str(file), file)


@pytest.mark.parametrize(("active", "held"), [("true", True), ("false", False)])
def test_a_coupled_joint_is_held_where_mujoco_has_it(
    tmp_path: Path, active: str, held: bool
) -> None:
    """Of joints that begin elsewhere than at zero (`ref`); an equality may be off."""
    file = tmp_path / "fingers.xml"
    finger = """<body name="{0}" pos="0 {1} 0"><joint name="{0}" axis="0 0 1" ref="{2}"
        range="-90 90"/><geom size=".01" pos=".1 0 0"/></body>"""
    file.write_text(
        f"""<mujoco><worldbody>{finger.format("first", 0.0, 10)}{finger.format("second", 1.0, 30)}
        </worldbody><equality><joint joint1="second" joint2="first" polycoef="0.1 2 0 0 0"
        active="{active}"/></equality></mujoco>""",
        encoding="utf-8",
    )
    model = RobotModel.from_urdf(find_urdf(str(file), file))
    assert ("second" not in model.joint_names) == held
    model.update(np.zeros(model.nq), np.zeros(model.nv))
    source = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(source)
    angle = np.deg2rad(30.0) + 0.1 - 2.0 * np.deg2rad(10.0) if held else 0.0
    data.qpos[:] = 0.0, angle
    mujoco.mj_kinematics(source, data)
    np.testing.assert_allclose(
        model.frame_rotation(model.frame_id("second")),
        data.body("second").xmat.reshape(3, 3),
        atol=AGREE,
    )


def test_shapes_are_where_the_mjcf_has_them(tmp_path: Path) -> None:
    """Boxes, spheres and meshes, in world coordinates; what is not to be seen is left out."""
    file = tmp_path / "shapes.xml"
    file.write_text(
        """<mujoco>
        <asset><mesh name="wedge" vertex="0 0 0  .3 0 0  0 .2 0  0 0 .1"/></asset>
        <worldbody><body name="arm" pos=".1 0 .2" euler="0 0 40"><joint axis="0 1 0"/>
          <geom type="box" size=".1 .2 .3" pos="0 .1 0" euler="10 20 30"/>
          <geom type="mesh" mesh="wedge" pos=".2 0 .1" euler="0 50 0" rgba="1 0 0 1"/>
          <geom type="sphere" size=".05" group="3"/>
        </body></worldbody></mujoco>""",
        encoding="utf-8",
    )
    text = for_mujoco(find_urdf(str(file), file), floating_base=False, shapes=True)
    theirs, ours = (
        mujoco.MjModel.from_xml_path(str(file)),
        mujoco.MjSpec.from_string(text).compile(),
    )
    assert ours.ngeom == 2
    clouds = []
    for model in (theirs, ours):
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        mesh = next(
            k for k in range(model.ngeom) if model.geom_type[k] == mujoco.mjtGeom.mjGEOM_MESH
        )
        box = next(
            k for k in range(model.ngeom) if model.geom_type[k] == mujoco.mjtGeom.mjGEOM_BOX
        )
        vertices = model.mesh_vert[: model.mesh_vertnum[0]]
        placed = vertices @ data.geom_xmat[mesh].reshape(3, 3).T + data.geom_xpos[mesh]
        corner = data.geom_xpos[box] + data.geom_xmat[box].reshape(3, 3) @ model.geom_size[box]
        clouds.append((placed[np.lexsort(placed.round(6).T)], corner))
    np.testing.assert_allclose(clouds[0][0], clouds[1][0], atol=1e-6)  # [m] STL: single precision
    np.testing.assert_allclose(clouds[0][1], clouds[1][1], atol=1e-9)

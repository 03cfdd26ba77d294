"""Contact wrenches: right sign, right size, right point of reference."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ghc_controller.types import Array
from ghc_sim_bridge.scene.description import load_scene
from ghc_sim_bridge.simulation.simulator import Simulator

TOUCH = 0.30  # [m] height of the frame `tool` when its ball lies on the table


def posture_with_tool_at(simulator: Simulator, target: list[float]) -> Array:
    """Inverse kinematics by Newton steps from a forward posture with the tool down."""
    q = np.array([0.1, -0.5, 0.1, 1.5, 0.0, -1.1, 0.0])
    for _ in range(50):
        simulator.reset(q)
        error = np.array(target) - simulator.frame_position("tool")
        q = q + np.linalg.pinv(simulator.frame_jacobian("tool")[:3]) @ error
    simulator.reset(q)
    return q


def rough_table(friction: float) -> Simulator:
    """The plane's scene with a friction that it does not have."""
    scene = load_scene("kuka_lwr_plane")
    return Simulator(replace(scene, contacts=(replace(scene.contacts[0], friction=friction),)))


def push(simulator: Simulator, force: list[float], seconds: float) -> Array:
    """Hold the arm and add J^T force; the wrench after that time (6,)."""
    for _ in range(round(seconds / simulator.control_dt)):
        jacobian = simulator.frame_jacobian("tool")[:3]
        simulator.step(simulator.hold_torque() + jacobian.T @ np.array(force))
    return simulator.contact_wrenches()["tool"]


def test_pushing_down_is_answered_by_the_same_force_upwards() -> None:
    simulator = Simulator("kuka_lwr_plane")
    for force in (1.0, 20.0, 50.0):  # [N]
        posture_with_tool_at(simulator, [0.45, 0.0, TOUCH])
        wrench = push(simulator, [0.0, 0.0, -force], 1.0)
        assert wrench[:3] == pytest.approx([0.0, 0.0, force], abs=1e-3 * force)
        assert wrench[3:] == pytest.approx(np.zeros(3), abs=1e-3 * force)
        assert simulator.state().wrenches["tool"] == pytest.approx(wrench)


def test_the_ground_gives_way_by_less_than_a_tenth_of_a_millimetre() -> None:
    simulator = Simulator("kuka_lwr_plane")
    posture_with_tool_at(simulator, [0.45, 0.0, TOUCH])
    push(simulator, [0.0, 0.0, -20.0], 1.0)
    depth = TOUCH - simulator.frame_position("tool")[2]
    assert 0.0 < depth < 1e-4


def test_the_wrench_closes_the_equation_of_motion() -> None:
    """M nudot + h = tau + J^T w while the tool presses, slides and lifts off: the wrench has the
    right sign, size and point of reference, friction and its torque about the frame included."""
    simulator = rough_table(friction=0.3)
    posture_with_tool_at(simulator, [0.45, 0.0, TOUCH])
    rng = np.random.default_rng(13)
    touching = 0
    for tick in range(300):
        if tick % 10 == 0:
            force = rng.uniform([-10.0, -10.0, -40.0], [10.0, 10.0, 0.0])
        jacobian = simulator.frame_jacobian("tool")
        mass, bias = simulator.mass_matrix(), simulator.bias()
        torque = simulator.hold_torque() + jacobian[:3].T @ force
        simulator.step(torque)
        wrench = simulator.contact_wrenches()["tool"]
        inertial = mass @ simulator.acceleration + bias - torque
        assert inertial == pytest.approx(jacobian.T @ wrench, abs=1e-8)
        touching += wrench[2] > 1.0
    assert 100 < touching < 300


def test_a_sliding_tool_feels_the_friction_coefficient() -> None:
    simulator = rough_table(friction=0.1)
    posture_with_tool_at(simulator, [0.45, 0.0, TOUCH])
    push(simulator, [0.0, 0.0, -20.0], 0.5)
    sliding = push(simulator, [6.0, 0.0, -20.0], 0.02)
    assert sliding[2] > 10.0
    assert sliding[0] == pytest.approx(-0.1 * sliding[2], rel=1e-3)
    # The force acts at the bottom of the ball: its arm to the frame's origin is the radius.
    assert sliding[4] == pytest.approx(-0.02 * sliding[0], rel=0.02)


def test_a_falling_ball_is_stopped_by_the_impulse_of_its_momentum(tmp_path: Path) -> None:
    """A known mass on a vertical slide: at rest its weight, on impact the lost momentum."""
    simulator = falling_ball(tmp_path, mass=2.0)
    simulator.reset([0.0], [-0.5])
    impulse, dt = 0.0, simulator.control_dt
    for _ in range(2000):
        simulator.step([0.0])
        impulse += simulator.contact_wrenches()["foot"][2] * dt
    assert simulator.contact_wrenches()["foot"][2] == pytest.approx(2.0 * 9.81, rel=1e-6)
    assert impulse == pytest.approx(2.0 * (0.5 + 9.81 * 2.0), rel=1e-6)


def test_no_contact_no_wrench_and_a_reset_forgets_it(tmp_path: Path) -> None:
    simulator = falling_ball(tmp_path, mass=2.0)
    simulator.reset([0.1], [0.0])
    simulator.step([0.0])
    assert np.array_equal(simulator.contact_wrenches()["foot"], np.zeros(6))
    for _ in range(2000):
        simulator.step([0.0])
    assert simulator.contact_wrenches()["foot"][2] > 1.0
    simulator.reset()
    assert np.array_equal(simulator.contact_wrenches()["foot"], np.zeros(6))


def test_a_wrench_is_the_mean_over_the_control_period(tmp_path: Path) -> None:
    """Momentum balance over each control period, whatever happens inside of it."""
    simulator = falling_ball(tmp_path, mass=2.0, control_dt=0.02)
    simulator.reset([0.0], [-0.5])
    for _ in range(50):
        before = simulator.state().v[0]
        simulator.step([0.0])
        force = simulator.contact_wrenches()["foot"][2]
        change = 2.0 * (simulator.state().v[0] - before) / simulator.control_dt
        assert force == pytest.approx(change + 2.0 * 9.81, abs=1e-6)


def falling_ball(folder: Path, mass: float, control_dt: float = 1e-3) -> Simulator:
    """A ball of 5 cm on a vertical slide, its lowest point on the floor at q = 0."""
    (folder / "ball.urdf").write_text(
        f"""<robot name="ball">
      <link name="rail"/>
      <joint name="height" type="prismatic">
        <parent link="rail"/><child link="ball"/>
        <origin xyz="0 0 0.05"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" velocity="10" effort="100"/>
      </joint>
      <link name="ball"><inertial><mass value="{mass}"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
      <joint name="centre_fixed" type="fixed"><parent link="ball"/><child link="centre"/></joint>
      <link name="centre"/>
    </robot>""",
        encoding="utf-8",
    )
    (folder / "robot.yaml").write_text(
        """
      name: ball
      urdf: ball.urdf
      tasks: [{name: height, kind: posture, stiffness: 1, damping: 1}]
      hierarchy: height
      contacts: [{name: foot, frame: centre, points: [[0, 0, -0.05]], normal: [0, 0, 1]}]
    """,
        encoding="utf-8",
    )
    (folder / "ball.yaml").write_text(
        """
      robot: ./robot.yaml
      start: {height: 0.0}
      surfaces: [{name: floor, kind: plane}]
      contacts: [{name: foot, radius: 0.05, inward: [0, 0, 1], friction: 0.0}]
      camera: {look_at: [0, 0, 0], distance: 1, azimuth: 0, elevation: 0}
    """,
        encoding="utf-8",
    )
    return Simulator(folder / "ball.yaml", control_dt, 1e-3)

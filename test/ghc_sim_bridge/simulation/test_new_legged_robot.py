"""`new_robot` on robots with legs: they stand on their feet, and swap two priorities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

import ghc_controller as ghc
from ghc_controller.contacts.contact import Contact
from ghc_controller.robot.first_files.legged import Stance
from ghc_controller.robot.first_files.new_robot import main, write_first_files
from ghc_controller.robot.library import load_robot
from ghc_controller.robot.robot import Robot
from ghc_controller.types import Array
from ghc_sim_bridge import Simulator
from ghc_sim_bridge.programs.check_robot import find_faults
from ghc_sim_bridge.scene.description import load_scene

QUADRUPED = Path(__file__).resolve().parents[2] / "models" / "quadruped.urdf"
MET, AT_REST = 1e-3, 1e-3  # [m] or [rad], [rad/s] mean over joints and the last second
SHORT, WHOLE = (0.002, 1.0, 3.0), (0.001, 2.0, 6.0)  # [s] control period, ramp and hold after it


def _swap(folder: Path, times: tuple[float, float, float]) -> list[tuple[float, float]]:
    """Error of the first task and mean joint speed at the end of each phase of swap.yaml."""
    period, ramp, hold = times
    robot = load_robot(folder)
    simulator = Simulator(folder / "scene.yaml", period, joint_names=robot.model.joint_names)
    controller = ghc.Controller(robot, ghc.Settings.of(control_dt=period))
    controller.start(simulator.state())
    scenario = yaml.safe_load((folder / "swap.yaml").read_text(encoding="utf-8"))
    for task, reference in scenario["references"].items():
        controller.set_reference(task, reference["position"])
    found = []
    for number, phase in enumerate(scenario["phases"][: 2 if times is SHORT else 3]):
        order = phase["hierarchy"]
        if number:
            controller.change_hierarchy(order, duration=ramp)
        end, speeds = simulator.time + ramp + hold, []
        while simulator.time < end - 1e-9:
            state = simulator.state()
            simulator.step(controller.step(state).torque)
            if simulator.time > end - 1.0:
                speeds.append(np.abs(state.v).mean())
        error = controller.report().errors[order.partition(" ")[0]]
        found.append((float(np.linalg.norm(error)), float(np.mean(speeds))))
    assert controller.counts["qp_failures"] == 0
    return found


def test_a_quadruped_stands_and_swaps_two_priorities(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "dog"
    assert main([str(QUADRUPED), "--folder", str(folder)]) == 0
    assert "stands on front_left_foot, front_right_foot, " in capsys.readouterr().out
    robot = load_robot(folder)
    assert list(find_faults(robot, load_scene(folder / "scene.yaml"))) == []
    assert robot.task_names == ("center_of_mass", "base_orientation", "posture")
    assert [len(contact.points) for contact in robot.contacts] == [1, 1, 1, 1]
    for error, speed in _swap(folder, SHORT):
        assert error <= MET
        assert speed <= AT_REST


def _places(robot: Robot, contact: Contact) -> Array:
    """Points of a contact in base axes, (p, 3) [m]."""
    model = robot.model
    return contact.points @ model.frame_rotation(contact.frame_id).T + model.frame_position(
        contact.frame_id
    )


def test_contacts_of_a_humanoid_are_its_soles(tmp_path: Path) -> None:
    """Within 1 cm of the points that iCub's robot.yaml has by hand, and 2 mm of their height."""
    chosen = write_first_files(load_robot("icub").urdf, tmp_path / "icub", "icub")
    assert isinstance(chosen, Stance)
    assert chosen.hand
    ours, given = load_robot(tmp_path / "icub"), load_robot("icub")
    for robot in (ours, given):
        robot.model.update(ours.model.q, np.zeros(ours.model.nv))
    soles = [_places(given, one) for one in given.contacts if one.name.endswith("_sole")]
    assert len(ours.contacts) == 2
    for contact in ours.contacts:
        assert contact.points.shape == (4, 3)
        corners = _places(ours, contact)
        by_hand = min(soles, key=lambda sole: np.linalg.norm(sole.mean(0) - corners.mean(0)))
        for point in corners:
            away = np.abs(by_hand - point)
            nearest = away[np.argmin(np.linalg.norm(away, axis=1))]
            assert nearest[:2].max() <= 0.01
            assert nearest[2] <= 0.002
    model, feet = ours.model, [contact.frame_id for contact in ours.contacts]
    model.update(np.concatenate([model.q[:7], chosen.start]), np.zeros(model.nv))
    middle = np.mean([model.frame_position(frame) for frame in feet], axis=0)
    assert (model.position_lower < chosen.start).all()
    assert (chosen.start < model.position_upper).all()
    assert np.abs(model.center_of_mass() - middle)[:2].max() < 0.05


@pytest.mark.long
def test_a_humanoid_stands_and_swaps_two_priorities(tmp_path: Path) -> None:
    write_first_files(load_robot("icub").urdf, tmp_path / "icub", "icub")
    for error, speed in _swap(tmp_path / "icub", WHOLE):
        assert error <= MET
        assert speed <= AT_REST

"""`new_robot`: what it writes is a robot that this stack takes, with reachable targets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from ghc_controller.errors import ConfigurationError
from ghc_controller.robot.first_files.choices import FIRST_TORQUE, Choices
from ghc_controller.robot.first_files.new_robot import main, write_first_files
from ghc_controller.robot.library import find_robot, load_robot

LWR = find_robot("kuka_lwr").parent


def _urdf() -> Path:
    return next(LWR.glob("*.urdf"))


def test_the_files_of_an_arm_load_and_its_targets_are_reached_together(tmp_path: Path) -> None:
    """The posture behind both targets is within limits; targets are no farther than it says."""
    chosen = write_first_files(_urdf(), tmp_path / "arm", "arm")
    assert isinstance(chosen, Choices)
    robot = load_robot(tmp_path / "arm")
    assert robot.task_names == ("end_effector", "elbow", "posture")
    model = robot.model
    assert (model.position_lower < chosen.start).all()
    assert (chosen.start < model.position_upper).all()
    scenario = yaml.safe_load((tmp_path / "arm/swap.yaml").read_text(encoding="utf-8"))
    given = [scenario["references"][name]["position"] for name in ("end_effector", "elbow")]
    assert np.abs(np.array(given) - chosen.targets).max() <= 5e-5  # four digits are written
    model.update(chosen.start, np.zeros(model.nv))
    moves = [
        np.linalg.norm(target - task.current(model))
        for target, task in zip(chosen.targets, robot.tasks[:2], strict=True)
    ]
    assert 0.01 < min(moves) <= max(moves) < 2.0 * chosen.reach


def test_names_that_yaml_would_read_as_something_else_are_quoted(tmp_path: Path) -> None:
    """Folder and joint with the names of a number, of true and with a comment's mark."""
    text = _urdf().read_text(encoding="utf-8")
    odd = tmp_path / "a #1, b: c" / "7.urdf"
    odd.parent.mkdir()
    names = {'"joint_1"': '"on"', '"joint_2"': '"2"'}
    for old, new in names.items():
        assert old in text
        text = text.replace(old, new)
    odd.write_text(text, encoding="utf-8")
    write_first_files(odd, tmp_path / "arm", "7")
    robot = load_robot(tmp_path / "arm")
    assert robot.name == "7"
    assert robot.urdf.resolve() == odd
    assert robot.model.joint_names[:2] == ("on", "2")
    for file, name in (("scene", "7"), ("swap", "7_swap")):
        given = yaml.safe_load((tmp_path / f"arm/{file}.yaml").read_text(encoding="utf-8"))
        assert given["name"] == name


def test_the_start_is_away_from_singular_postures(tmp_path: Path) -> None:
    chosen = write_first_files(_urdf(), tmp_path / "arm", "arm")
    assert isinstance(chosen, Choices)
    model = load_robot(tmp_path / "arm").model

    def least(q: np.ndarray) -> float:
        model.update(q, np.zeros(model.nv))
        jacobian = model.frame_jacobian(model.frame_id(chosen.end_effector))[:3]
        return float(np.linalg.svd(jacobian, compute_uv=False)[-1])

    assert least(np.zeros(model.nq)) < 1e-6 < 0.1 < least(chosen.start)


def test_limits_that_the_urdf_lacks_are_set_small_and_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = _urdf().read_text(encoding="utf-8")
    bare = tmp_path / "bare.urdf"
    start = text.index('effort="')
    end = text.index('"', start + 8)
    bare.write_text(text[:start] + 'effort="0' + text[end:], encoding="utf-8")
    assert main([str(bare), "--folder", str(tmp_path / "bare")]) == 0
    said = capsys.readouterr().out
    model = load_robot(tmp_path / "bare").model
    assert f"no torque limit of {model.joint_names[0]}" in said
    assert model.torque_limit[0] == FIRST_TORQUE


def test_what_it_cannot_serve_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """No file; files that are there already; a robot that is no arm."""
    assert main([str(tmp_path / "none.urdf"), "--folder", str(tmp_path / "a")]) == 1
    assert "robot model does not exist" in capsys.readouterr().err
    write_first_files(_urdf(), tmp_path / "arm", "arm")
    with pytest.raises(ConfigurationError, match="exists already; give another --folder"):
        write_first_files(_urdf(), tmp_path / "arm", "arm")
    pendulum = tmp_path / "pendulum.urdf"
    pendulum.write_text(
        """<robot name="p"><link name="base"/><link name="bar"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="j" type="revolute"><parent link="base"/><child link="bar"/>
        <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="10" velocity="2"/></joint></robot>
        """,
        encoding="utf-8",
    )
    with pytest.raises(ConfigurationError, match="moved by three joints, at most 1"):
        write_first_files(pendulum, tmp_path / "pendulum", "pendulum")
    assert not (tmp_path / "pendulum").exists()

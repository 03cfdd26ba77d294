"""Joints that the controller does not know become simpler ones, in one file for both engines."""

from __future__ import annotations

import logging
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

from ghc_controller.errors import ConfigurationError
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.robot.urdf import find_urdf
from ghc_controller.robot.urdf_joints import TURNS

INERTIAL = """<inertial><origin xyz="0 0 0.1"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>"""


def _write(folder: Path, middle: str, head: str = '<robot name="r">') -> Path:
    """Three links in a row: joint `first` is revolute, joint `second` is what the test gives."""
    file = folder / "r.urdf"
    file.write_text(
        f"""{head}<link name="base"/>
        <link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link>
        <joint name="first" type="revolute"><parent link="base"/><child link="a"/>
        <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="10" velocity="2"/></joint>
        <joint name="second" {middle}</joint></robot>""",
        encoding="utf-8",
    )
    return file


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


ENDS = '<parent link="a"/><child link="b"/><origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/>'


@pytest.mark.parametrize(
    ("kind", "offset"), [("revolute", 0.7), ("prismatic", 0.05), ("revolute", 0.0)]
)
def test_a_mimic_joint_is_held_where_the_other_is_at_zero(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, kind: str, offset: float
) -> None:
    """The frame stands where the free joint at its offset would put it, to 1e-12."""
    limit = '<limit lower="-2" upper="2" effort="10" velocity="2"/><axis xyz="1 2 0.5"/>'
    free = _write(tmp_path, f'type="{kind}">{ENDS}{limit}')
    model = pin.buildModelFromUrdf(str(free))
    data = model.createData()
    q = np.array([0.4, offset])
    pin.framesForwardKinematics(model, data, q)
    expected = data.oMf[model.getFrameId("b")].homogeneous.copy()
    mimic = f'<mimic joint="first" multiplier="2" offset="{offset}"/>'
    file = _write(tmp_path, f'type="{kind}">{ENDS}{limit}{mimic}')
    with caplog.at_level(logging.WARNING):
        held = RobotModel.from_urdf(find_urdf(str(file), tmp_path / "robot.yaml"))
    assert held.joint_names == ("first",)
    assert "mimic joints are held still: second" in caplog.text
    held.update(q[:1], np.zeros(1))
    frame = held.frame_id("b")
    assert np.abs(held.frame_position(frame) - expected[:3, 3]).max() < 1e-12
    assert np.abs(held.frame_rotation(frame) - expected[:3, :3]).max() < 1e-12


def test_a_continuous_joint_gets_limits_and_keeps_its_motion(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    limit = '<limit effort="10" velocity="2"/><axis xyz="0 0 1"/>'
    file = _write(tmp_path, f'type="continuous">{ENDS}{limit}')
    with caplog.at_level(logging.WARNING):
        model = RobotModel.from_urdf(find_urdf(str(file), tmp_path / "robot.yaml"))
    assert "continuous joints may turn 100 times either way: second" in caplog.text
    assert model.position_upper[1] == pytest.approx(2.0 * np.pi * TURNS)
    frame = model.frame_id("b")
    model.update(np.array([0.3, 0.5]), np.zeros(2))
    before = model.frame_rotation(frame).copy()
    model.update(np.array([0.3, 0.5 + 2.0 * np.pi]), np.zeros(2))
    assert np.abs(model.frame_rotation(frame) - before).max() < 1e-9


def test_a_file_that_needs_nothing_is_read_as_it_is(tmp_path: Path) -> None:
    limit = '<limit lower="-1" upper="1" effort="10" velocity="2"/><axis xyz="0 0 1"/>'
    file = _write(tmp_path, f'type="revolute">{ENDS}{limit}')
    assert find_urdf(str(file), tmp_path / "robot.yaml") == file


def test_a_joint_that_moves_no_mass_is_named(tmp_path: Path) -> None:
    limit = '<limit lower="-1" upper="1" effort="10" velocity="2"/><axis xyz="0 0 1"/>'
    file = _write(tmp_path, f'type="revolute">{ENDS}{limit}')
    text = file.read_text(encoding="utf-8")
    last = text.rindex(INERTIAL)
    file.write_text(text[:last] + text[last + len(INERTIAL) :], encoding="utf-8")
    with pytest.raises(ConfigurationError, match="joint 'second' moves no mass"):
        RobotModel.from_urdf(file)


def test_xacro_is_expanded_by_its_package_or_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a stand-in for the package: what it returns is what both engines read."""
    limit = '<limit lower="-1" upper="1" effort="10" velocity="2"/><axis xyz="0 0 1"/>'
    plain = _write(tmp_path, f'type="revolute">{ENDS}{limit}').read_text(encoding="utf-8")
    file = tmp_path / "r.urdf.xacro"
    file.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/></robot>',
        encoding="utf-8",
    )
    monkeypatch.setitem(sys.modules, "xacro", None)
    with pytest.raises(ConfigurationError, match="package 'xacro' is not installed"):
        find_urdf(str(file), tmp_path / "robot.yaml")
    package = ModuleType("xacro")
    package.process_file = lambda _: SimpleNamespace(toxml=lambda: plain)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "xacro", package)
    found = find_urdf(str(file), tmp_path / "robot.yaml")
    assert RobotModel.from_urdf(found).joint_names == ("first", "second")


def test_an_mjcf_needs_the_package_that_reads_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "arm.xml"
    file.write_text("<mujoco><worldbody/></mujoco>", encoding="utf-8")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ConfigurationError, match=r"an MJCF, and the Python package 'mujoco'.*pip"):
        find_urdf(str(file), tmp_path / "robot.yaml")

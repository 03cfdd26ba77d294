"""`check_robot`: both engines are compared, and what is wrong is said."""

from __future__ import annotations

from pathlib import Path

import pytest

from ghc_controller.robot.first_files.new_robot import write_first_files
from ghc_controller.robot.library import find_robot
from ghc_sim_bridge.programs.check_robot import main


@pytest.mark.parametrize(
    "arguments", [["kuka_lwr", "--scene", "kuka_lwr"], ["icub", "--scene", "icub_standing"]]
)
def test_the_shipped_robots_have_no_fault(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """Mass matrix and bias of both engines agree to 1e-6, fixed and floating base."""
    assert main(arguments) == 0
    assert "nothing wrong was found" in capsys.readouterr().out


def test_a_mesh_that_is_missing_and_a_scene_of_another_kind_are_faults(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    urdf = next(find_robot("kuka_lwr").parent.glob("*.urdf")).read_text(encoding="utf-8")
    mesh = '<visual><geometry><mesh filename="none.stl"/></geometry></visual></link>'
    (tmp_path / "arm.urdf").write_text(urdf.replace("</link>", mesh, 1), encoding="utf-8")
    write_first_files(tmp_path / "arm.urdf", tmp_path / "arm", "arm")
    assert main([str(tmp_path / "arm/robot.yaml")]) == 1
    said = capsys.readouterr()
    assert "mesh 'none.stl' does not exist" in said.err
    assert "| joint |" in said.out
    assert main(["icub", "--scene", "kuka_lwr"]) == 1


def test_a_wrong_file_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "robot.yaml").write_text("name: r\n", encoding="utf-8")
    assert main([str(tmp_path / "robot.yaml")]) == 1
    error = capsys.readouterr().err
    assert error.startswith("check_robot: ") and error.count("\n") == 1

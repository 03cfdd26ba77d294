"""The robots of the package: they are found by name or path, and the data are physical."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio
import pytest
import yaml

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robot.library import find_robot, list_robots
from ghc_controller.robot.urdf import find_urdf


def test_a_robot_is_found_by_name_by_file_and_by_folder() -> None:
    file = find_robot("kuka_lwr")
    assert file.name == "robot.yaml"
    assert "kuka_lwr" in list_robots()
    assert find_robot(file) == find_robot(str(file)) == find_robot(file.parent)


def test_an_unknown_robot_is_refused_with_the_names_that_exist(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match=r"unknown robot 'kuka'; known: .*kuka_lwr"):
        find_robot("kuka")
    with pytest.raises(ConfigurationError, match=r"nowhere.*does not exist.*kuka_lwr"):
        find_robot(tmp_path / "nowhere")


@pytest.mark.parametrize("name", list_robots())
def test_robot_files_name_frames_and_joints_of_their_urdf(name: str) -> None:
    file = find_robot(name)
    robot = yaml.safe_load(file.read_text(encoding="utf-8"))
    urdf = find_urdf(robot["urdf"], file)  # `make test` installs models that are packages
    model = pinocchio.buildModelFromUrdf(str(urdf))
    frames = {frame.name for frame in model.frames}
    for task in robot["tasks"]:
        assert "frame" not in task or task["frame"] in frames
        assert set(task.get("reference", {})) <= set(model.names)


def test_kuka_lengths_are_the_published_ones() -> None:
    """Stretched upwards, every axis meets the z axis at its published height."""
    model = pinocchio.buildModelFromUrdf(str(find_robot("kuka_lwr").parent / "kuka_lwr.urdf"))
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, np.zeros(7))
    heights = [
        data.oMf[model.getFrameId(n)].translation[2] for n in ("link_2", "elbow", "link_6", "tool")
    ]
    assert np.diff([0.0, *heights]) == pytest.approx([0.3105, 0.4, 0.39, 0.078])
    assert [data.oMi[k].translation[:2].tolist() for k in range(1, 8)] == [[0.0, 0.0]] * 7


def test_kuka_limits_are_those_of_the_data_sheet() -> None:
    model = pinocchio.buildModelFromUrdf(str(find_robot("kuka_lwr").parent / "kuka_lwr.urdf"))
    assert model.effortLimit.tolist() == [176, 176, 100, 100, 100, 38, 38]  # [Nm]
    degrees = [170, 120, 170, 120, 170, 120, 170]
    assert model.upperPositionLimit == pytest.approx(np.radians(degrees))
    assert model.lowerPositionLimit == pytest.approx(-np.radians(degrees))
    speeds = [110, 110, 128, 128, 204, 184, 184]
    assert model.velocityLimit == pytest.approx(np.radians(speeds))


def test_kuka_inertias_belong_to_rigid_bodies() -> None:
    """Positive masses, tensors that some distribution of mass can have, sizes of an arm."""
    model = pinocchio.buildModelFromUrdf(str(find_robot("kuka_lwr").parent / "kuka_lwr.urdf"))
    assert pinocchio.computeTotalMass(model) == pytest.approx(12.416, abs=1e-3)  # [kg]
    for body in list(model.inertias)[1:]:
        moments = np.linalg.eigvalsh(body.inertia)
        assert body.mass > 0.1 and moments[0] > 0.0
        assert moments[2] <= moments[0] + moments[1]
        assert np.sqrt(moments[2] / body.mass) < 0.1  # [m] radius of gyration

"""A URDF on another root, with locked joints and added frames, moves as the robot that it was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.urdf import find_urdf

PACKAGE = {"package": "icub-models", "file": "share/iCub/robots/iCubGazeboV2_5/model.urdf"}
LOCKED = ["l_wrist_pitch", "l_wrist_yaw", "r_wrist_pitch", "r_wrist_yaw"]
FRAMES = ("l_sole", "l_hand_dh_frame", "head", "chest", "l_upper_leg_back_contact")


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return np.triu(matrix) + np.triu(matrix, 1).T


def test_a_humanoid_on_its_sole_has_the_frames_and_the_inertia_of_the_floating_one() -> None:
    """Frames, center of mass, mass matrix with the sole at rest, to 1e-12: 5 postures, seed 0."""
    entry = PACKAGE | {"root": "r_sole", "locked": LOCKED}
    fixed = pin.buildModelFromUrdf(str(find_urdf(entry, Path("robot.yaml"))))
    whole = pin.buildModelFromUrdf(
        str(find_urdf(PACKAGE, Path("robot.yaml"))), pin.JointModelFreeFlyer()
    )
    locked = [whole.getJointId(name) for name in LOCKED]
    free = pin.buildReducedModel(whole, locked, pin.neutral(whole))
    assert fixed.nv == free.nv - 6 == 28
    a, b = fixed.createData(), free.createData()
    names = list(fixed.names)[1:]
    rng = np.random.default_rng(0)
    for _ in range(5):
        q, q_free = rng.uniform(-0.6, 0.6, size=28), pin.neutral(free)
        for name, value in zip(names, q, strict=True):
            q_free[free.idx_qs[free.getJointId(name)]] = value
        pin.framesForwardKinematics(fixed, a, q)
        pin.framesForwardKinematics(free, b, q_free)
        sole = b.oMf[free.getFrameId("r_sole")]
        for frame in FRAMES:
            expected = (sole.inverse() * b.oMf[free.getFrameId(frame)]).homogeneous
            found = a.oMf[fixed.getFrameId(frame)].homogeneous
            assert np.abs(found - expected).max() < 1e-12
        foot, moving = fixed.inertias[0], pin.computeTotalMass(fixed)
        center = pin.centerOfMass(fixed, a, q) * moving + foot.mass * foot.lever
        expected = sole.actInv(pin.centerOfMass(free, b, q_free))
        assert np.abs(center / (moving + foot.mass) - expected).max() < 1e-12
        jacobian = pin.computeFrameJacobian(free, b, q_free, free.getFrameId("r_sole"), pin.LOCAL)
        base = -np.linalg.solve(jacobian[:, :6], jacobian[:, 6:])
        still = np.vstack([base, np.eye(28)])
        mass = still.T @ _symmetric(pin.crba(free, b, q_free)) @ still
        order = [free.idx_vs[free.getJointId(name)] - 6 for name in names]
        found = _symmetric(pin.crba(fixed, a, q))
        assert np.abs(found - mass[np.ix_(order, order)]).max() < 1e-12


def test_an_arm_with_locked_joints_has_the_inertia_of_the_whole_one_with_them_at_zero() -> None:
    """Mass matrix of the joints left and pose of the tool, to 1e-12: 10 postures, seed 0."""
    file = find_robot("kuka_lwr")
    names = ["joint_2", "joint_7"]
    part = pin.buildModelFromUrdf(str(find_urdf({"file": "kuka_lwr.urdf", "locked": names}, file)))
    whole = pin.buildModelFromUrdf(str(file.parent / "kuka_lwr.urdf"))
    left = [k for k in range(7) if f"joint_{k + 1}" not in names]
    assert list(part.names)[1:] == [f"joint_{k + 1}" for k in left]
    a, b = whole.createData(), part.createData()
    rng = np.random.default_rng(0)
    for _ in range(10):
        q = np.zeros(7)
        q[left] = rng.uniform(-1.0, 1.0, size=len(left))
        expected = _symmetric(pin.crba(whole, a, q))[np.ix_(left, left)]
        assert np.abs(_symmetric(pin.crba(part, b, q[left])) - expected).max() < 1e-12
        pin.framesForwardKinematics(whole, a, q)
        pin.framesForwardKinematics(part, b, q[left])
        tool = a.oMf[whole.getFrameId("tool")].homogeneous
        assert np.abs(b.oMf[part.getFrameId("tool")].homogeneous - tool).max() < 1e-12


def test_a_frame_is_where_it_is_put_and_an_arm_can_hang_from_its_tool(tmp_path: Path) -> None:
    source = find_robot("kuka_lwr").parent / "kuka_lwr.urdf"
    entry = {
        "file": str(source),
        "root": "tool",
        "locked": ["joint_7"],
        "frames": {"pen": {"link": "tool", "position": [0.0, 0.1, 0.2]}},
    }
    model = pin.buildModelFromUrdf(str(find_urdf(entry, tmp_path / "robot.yaml")))
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(6))
    assert model.nv == 6
    np.testing.assert_allclose(
        data.oMf[model.getFrameId("pen")].translation, [0.0, 0.1, 0.2], atol=1e-12
    )


def test_the_changed_file_is_written_once_and_follows_its_source(tmp_path: Path) -> None:
    text = (find_robot("kuka_lwr").parent / "kuka_lwr.urdf").read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    entry = {"file": "arm.urdf", "locked": ["joint_7"]}
    first = find_urdf(entry, tmp_path / "robot.yaml")
    written = first.stat().st_mtime_ns
    assert find_urdf(entry, tmp_path / "robot.yaml") == first
    assert first.stat().st_mtime_ns == written
    (tmp_path / "arm.urdf").write_text(text.replace('effort="38"', 'effort="39"'), "utf-8")
    assert find_urdf(entry, tmp_path / "robot.yaml") != first
    assert (
        find_urdf({"file": "arm.urdf", "locked": []}, tmp_path / "robot.yaml").name == "arm.urdf"
    )


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"root": "moon"}, UnknownName, "unknown link of .*'moon'"),
        ({"locked": ["hinge"]}, UnknownName, "unknown joint of .*'hinge'"),
        ({"frames": {"a": {"link": "b", "position": [0, 0, 0]}}}, UnknownName, "'b'"),
        ({"frames": {"a": {"link": "tool"}}}, ConfigurationError, "urdf.frames.a.position"),
        ({"roof": "tool"}, ConfigurationError, "urdf.roof: unknown field; known: file, package"),
        ({"locked": "joint_7"}, ConfigurationError, "urdf.locked: a list of names"),
        ({"file": "robot.yaml", "locked": ["joint_7"]}, ConfigurationError, "be read as XML"),
    ],
)
def test_what_the_urdf_has_not_is_rejected_by_name(
    changes: dict[str, object], error: type[Exception], message: str
) -> None:
    file = find_robot("kuka_lwr")
    with pytest.raises(error, match=message):
        find_urdf({"file": "kuka_lwr.urdf"} | changes, file)


def test_a_cache_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file where the folder should be", encoding="utf-8")
    with pytest.raises(ConfigurationError, match=r"ghc_controller/urdf/.*cannot be written"):
        find_urdf({"file": "kuka_lwr.urdf", "locked": ["joint_7"]}, find_robot("kuka_lwr"))

"""A URDF with fixed joints: a smaller robot, the same bodies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.robots import find_robot
from ghc_controller.urdf_source import find_urdf, resource_path
from ghc_controller.urdf_variant import with_fixed_joints

KUKA = find_robot("kuka_lwr").parent / "kuka_lwr.urdf"
FIXED = ("joint_2", "joint_7")


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "ghc_controller" / "urdf"


def test_dynamics_are_those_of_the_whole_robot_with_joints_at_zero() -> None:
    """Mass matrix of the joints that are left, and the place of the last link: 10 states."""
    rng = np.random.default_rng(0)
    whole = pin.buildModelFromUrdf(str(KUKA))
    part = pin.buildModelFromUrdf(str(with_fixed_joints(KUKA, FIXED, resource_path)))
    left = [k for k in range(7) if f"joint_{k + 1}" not in FIXED]
    assert list(part.names)[1:] == [f"joint_{k + 1}" for k in left]
    data, small = whole.createData(), part.createData()
    for _ in range(10):
        q = np.zeros(7)
        q[left] = rng.uniform(-1.0, 1.0, len(left))
        M, m = pin.crba(whole, data, q), pin.crba(part, small, q[left])
        assert np.abs(np.triu(M)[np.ix_(left, left)] - np.triu(m)).max() < 1e-12
        pin.framesForwardKinematics(whole, data, q)
        pin.framesForwardKinematics(part, small, q[left])
        places = [d.oMf[r.getFrameId("tool")] for r, d in ((whole, data), (part, small))]
        assert np.abs(places[0].homogeneous - places[1].homogeneous).max() < 1e-12


def test_a_copy_is_written_once(cache: Path) -> None:
    """The same joints give the same file, others another one, and nothing else is left behind."""
    first = with_fixed_joints(KUKA, FIXED, resource_path)
    before = first.stat().st_mtime_ns
    assert with_fixed_joints(KUKA, FIXED, resource_path) == first
    assert first.stat().st_mtime_ns == before
    other = with_fixed_joints(KUKA, FIXED[:1], resource_path)
    assert sorted(cache.iterdir()) == sorted([first, other])


def test_what_cannot_be_fixed_is_named(cache: Path) -> None:
    with pytest.raises(UnknownName, match=r"'joint_9'; known: joint_1"):
        with_fixed_joints(KUKA, ["joint_9"], resource_path)
    with pytest.raises(ConfigurationError, match="cannot be read as XML"):
        with_fixed_joints(KUKA.parent / "robot.yaml", FIXED, resource_path)
    cache.parent.parent.mkdir(exist_ok=True)
    cache.parent.write_text("a file where the folder should be")
    with pytest.raises(ConfigurationError, match="cannot be written"):
        with_fixed_joints(KUKA, FIXED, resource_path)


def test_only_a_list_of_names_is_one_of_joints() -> None:
    entry = {"package": "toy-models", "file": "a.urdf", "fixed_joints": "neck"}
    with pytest.raises(ConfigurationError, match="'fixed_joints': 'neck'} given"):
        find_urdf(entry, Path("some/robot.yaml"))

"""Joints are matched by name, whatever the order on either side."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import ConfigurationError, WrongSize
from ghc_sim_bridge.simulation.joint_map import JointMap

NAMES = ("hip", "knee", "ankle", "toe")


def test_values_find_their_joint_in_a_permuted_order() -> None:
    joints = JointMap(NAMES, ("toe", "hip", "ankle", "knee"))
    assert joints.from_simulator(np.array([4.0, 1.0, 3.0, 2.0])).tolist() == [1, 2, 3, 4]
    assert joints.to_simulator(np.array([1.0, 2.0, 3.0, 4.0])).tolist() == [4, 1, 3, 2]
    assert joints.names == NAMES


def test_there_and_back_is_the_identity_for_any_order() -> None:
    rng = np.random.default_rng(21)
    for _ in range(20):
        joints = JointMap(NAMES, tuple(rng.permutation(NAMES).tolist()))
        values = rng.normal(size=4)
        assert np.array_equal(joints.from_simulator(joints.to_simulator(values)), values)


def test_matrices_are_permuted_so_that_products_stay_the_same() -> None:
    """x^T M x and J x do not depend on how joints are counted."""
    rng = np.random.default_rng(22)
    joints = JointMap(NAMES, ("knee", "toe", "ankle", "hip"))
    square, rows, x = rng.normal(size=(4, 4)), rng.normal(size=(3, 4)), rng.normal(size=4)
    native = joints.to_simulator(x)
    assert x @ joints.from_simulator(square) @ x == pytest.approx(native @ square @ native)
    assert joints.columns_from_simulator(rows) @ x == pytest.approx(rows @ native)


def test_joints_missing_on_either_side_are_named() -> None:
    with pytest.raises(ConfigurationError) as error:
        JointMap(("hip", "knee", "ankle"), ("hip", "tail"))
    assert str(error.value) == (
        "joints do not match: the simulator has no 'knee', 'ankle'; the robot model has no 'tail'"
    )


def test_a_joint_that_occurs_twice_is_named() -> None:
    with pytest.raises(ConfigurationError, match="the robot model has joints twice: knee"):
        JointMap(("knee", "hip", "knee"), ("knee", "hip"))


def test_a_wrong_number_of_values_is_refused() -> None:
    with pytest.raises(WrongSize, match="hip, knee, ankle, toe: size 3 given, 4 expected"):
        JointMap(NAMES, NAMES).to_simulator(np.zeros(3))

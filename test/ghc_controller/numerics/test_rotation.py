"""Quaternions and rotation vectors against Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from ghc_controller.numerics.rotation import (
    angular_motion,
    matrix_from_quaternion,
    quaternion_from_matrix,
    quaternion_product,
    rotation_exp,
    rotation_log,
    vector_motion,
)
from ghc_controller.types import Array

LENGTHS = (0.0, 1e-9, 1e-5, 1e-3, 0.019, 0.021, 1.0, 3.0, 3.14159)  # [rad]


def _vectors() -> list[Array]:
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(len(LENGTHS), 3))
    return [s * d / np.linalg.norm(d) for s, d in zip(LENGTHS, directions, strict=True)]


@pytest.mark.parametrize("vector", _vectors())
def test_exp_and_log_are_inverse_and_match_matrices(vector: Array) -> None:
    """Round trips through quaternion and matrix, up to pi."""
    quaternion = rotation_exp(vector)
    assert np.isclose(np.linalg.norm(quaternion), 1.0, atol=1e-12)
    assert np.allclose(matrix_from_quaternion(quaternion), pin.exp3(vector), atol=1e-12)
    assert np.allclose(rotation_log(quaternion), vector, atol=1e-9)
    back = quaternion_from_matrix(pin.exp3(vector))
    assert np.allclose(back * np.sign(back[3] + 1e-30), quaternion, atol=1e-8)


def test_both_signs_of_a_quaternion_are_the_same_rotation() -> None:
    """The logarithm takes the short way whatever the sign."""
    quaternion = rotation_exp(np.array([0.3, -0.2, 1.0]))
    assert np.allclose(rotation_log(quaternion), rotation_log(-quaternion), atol=1e-15)


@pytest.mark.parametrize("seed", range(20))
def test_product_matches_matrices_and_large_turns(seed: int) -> None:
    """Also rotations beyond 90 degrees, where the matrix formula changes branch."""
    rng = np.random.default_rng(seed)
    a, b = (rng.normal(size=4) for _ in range(2))
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    product = matrix_from_quaternion(a) @ matrix_from_quaternion(b)
    assert np.allclose(matrix_from_quaternion(quaternion_product(a, b)), product, atol=1e-12)
    assert np.allclose(
        matrix_from_quaternion(quaternion_from_matrix(product)), product, atol=1e-12
    )


@pytest.mark.parametrize("vector", _vectors())
def test_angular_motion_matches_finite_differences(vector: Array) -> None:
    """w and w' of exp(p(t)) in its own axes, and their inverse map."""
    rng = np.random.default_rng(1)
    rate, change = rng.normal(size=(2, 3))
    omega, alpha = angular_motion(vector, rate, change)
    step = 1e-5

    def path(t: float) -> Array:
        return vector + t * rate + 0.5 * t * t * change

    def omega_at(t: float) -> Array:
        return angular_motion(path(t), rate + t * change, change)[0]

    turn = pin.exp3(path(-step)).T @ pin.exp3(path(step))
    assert np.allclose(pin.log3(turn) / (2.0 * step), omega, atol=1e-7)
    assert np.allclose((omega_at(step) - omega_at(-step)) / (2.0 * step), alpha, atol=1e-7)
    back_rate, back_change = vector_motion(vector, omega, alpha)
    assert np.allclose(back_rate, rate, atol=1e-9)
    assert np.allclose(back_change, change, atol=1e-9)

"""Targets, metrics and systems of `ghc`, `balanced` and `weighted` against dense formulas.

Projectors by pseudoinverses are in `problem/test_fast_paths.py`; here they are given.
"""

from __future__ import annotations

import numpy as np
import pytest
from random_problems import random_alpha, strict_alpha

from ghc_controller.core import native
from ghc_controller.types import Array, Starts

_W = 1e-2
_TOLERANCE = 1e-7


def _stack(seed: int) -> tuple[Array, Array, Starts, Array]:
    """J (m, d), b (m,), starts, alpha; every other one has a posture, some tasks stand twice."""
    rng = np.random.default_rng(seed)
    d, k = int(rng.integers(3, 33)), int(rng.integers(2, 6))
    blocks = [rng.normal(size=(int(rng.integers(1, 7)), d)) for _ in range(k)]
    if seed % 2:
        blocks[int(rng.integers(k))] = np.diag(rng.uniform(0.5, 2.0, d))
    if seed % 3 == 0:
        blocks[-1] = blocks[0].copy()
    order = rng.permutation(k)
    alpha = strict_alpha(k)[np.ix_(order, order)] if seed % 4 else random_alpha(rng, k)
    starts = np.concatenate([[0], np.cumsum([len(block) for block in blocks])])
    jacobian = np.vstack(blocks)
    return jacobian, rng.normal(size=len(jacobian)), starts, alpha


def _tasks(jacobian: Array, starts: Starts) -> list[Array]:
    return np.split(jacobian, starts[1:-1])


@pytest.mark.parametrize("damping", [0.0, 2.5e-6])
@pytest.mark.parametrize("seed", range(12))
def test_target_and_factor_of_ghc(seed: int, damping: float) -> None:
    jacobian, target, starts, alpha = _stack(seed)
    d = jacobian.shape[1]
    rule = (_TOLERANCE, damping)
    projectors = native.generalized_projectors(jacobian, starts, alpha, *rule)
    wanted, metric = np.zeros(d), np.zeros((d, d))
    for J, b, P in zip(
        _tasks(jacobian, starts), np.split(target, starts[1:-1]), projectors, strict=True
    ):
        inverse = np.linalg.inv(J @ J.T + _W * np.eye(len(J)))
        wanted += P @ J.T @ inverse @ b
        metric += P @ P - P @ J.T @ inverse @ J @ P
    found, same = native.ghc_target(jacobian, target, starts, alpha, _W, *rule)
    assert np.array_equal(same, projectors)
    assert np.abs(found - wanted).max() < 1e-10 * max(1.0, np.abs(wanted).max())
    factor = native.ghc_factor(jacobian, starts, alpha, projectors, _W, damping)
    assert np.array_equal(factor, np.tril(factor))
    assert np.abs(factor @ factor.T - metric).max() < 1e-10


@pytest.mark.parametrize("seed", range(12))
def test_system_and_target_of_balanced(seed: int) -> None:
    """With one task removed; a guard above sigma_min damps the target, continuously."""
    jacobian, target, starts, alpha = _stack(seed)
    alpha[-1, -1] = 1.0
    d = jacobian.shape[1]
    rule = (_W, _TOLERANCE, 2.5e-6)
    system, projectors = native.balanced_system(jacobian, starts, alpha, *rule)
    right, wanted = np.zeros(d), _W * np.eye(d)
    tasks = zip(_tasks(jacobian, starts), np.split(target, starts[1:-1]), projectors, strict=True)
    for J, b, P in list(tasks)[:-1]:
        wanted += P @ J.T @ J
        right += P @ J.T @ b
    assert np.abs(system - wanted).max() < 1e-10
    x, sigma = native.balanced_target(jacobian, target, starts, alpha, *rule, 0.0)
    assert np.abs(system @ x - right).max() < 1e-9
    assert sigma == pytest.approx(1.0 / np.linalg.norm(np.linalg.inv(system)), rel=1e-6)
    guard = 1.5 * sigma
    damped, _ = native.balanced_target(jacobian, target, starts, alpha, *rule, guard)
    normal = system.T @ system + (guard**2 - sigma**2) * np.eye(d)
    assert np.abs(normal @ damped - system.T @ right).max() < 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_system_of_weighted(seed: int) -> None:
    jacobian, target, starts, alpha = _stack(seed)
    weights = native.priority_weights(alpha, 1e3, 1e6)
    rows = np.repeat(weights, np.diff(starts))
    hessian, right = native.weighted_system(jacobian, target, starts, alpha, 1e3, 1e6, 0.5)
    wanted = jacobian.T @ (rows[:, None] * jacobian) + 0.5 * np.eye(jacobian.shape[1])
    assert np.abs(hessian - wanted).max() < 1e-10 * np.abs(wanted).max()
    assert np.array_equal(hessian, hessian.T)
    assert np.abs(right - jacobian.T @ (rows * target)).max() < 1e-10 * np.abs(right).max()


def test_rows_that_do_not_fit_are_told() -> None:
    """Not read beyond their end."""
    jacobian, target, starts, alpha = _stack(0)
    beyond, backwards = starts.copy(), starts[::-1].copy()
    beyond[-1] += 1
    for wrong in (beyond, backwards, starts[:-1]):
        with pytest.raises(ValueError, match="first rows"):
            native.balanced_system(jacobian, wrong, alpha, _W, _TOLERANCE, 0.0)
    with pytest.raises(ValueError, match="target"):
        native.ghc_target(jacobian, target[1:], starts, alpha, _W, _TOLERANCE, 0.0)


def test_other_layouts_and_types_are_copied() -> None:
    jacobian, target, starts, alpha = _stack(1)
    wanted, _ = native.balanced_target(jacobian, target, starts, alpha, _W, _TOLERANCE, 0.0, 0.0)
    fortran, spread = np.asfortranarray(jacobian), np.repeat(target, 2)[::2]
    short = starts.astype(np.int32)
    found, _ = native.balanced_target(fortran, spread, short, alpha, _W, _TOLERANCE, 0.0, 0.0)
    assert np.array_equal(found, wanted)


@pytest.mark.parametrize("offset", [0, 4, 8])
def test_values_of_a_message_need_not_be_aligned(offset: int) -> None:
    values = np.frombuffer(bytes(offset) + np.arange(5.0).tobytes(), offset=offset)
    ordered, finite = native.in_order(values, np.array([3, 0]))
    assert ordered.tolist() == [3.0, 0.0]
    assert finite

"""Generalized projectors: limits at 0 and 1, strictness, continuity, damped layers."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from random_problems import random_alpha, strict_alpha

from ghc_controller.hierarchy import (
    ProjectorSettings,
    generalized_projectors,
    smallest_singular_value,
)
from ghc_controller.types import Array


def _rows(rng: np.random.Generator, n: int, sizes: list[int]) -> tuple[Array, Array]:
    return rng.normal(size=(sum(sizes), n)), np.concatenate([[0], np.cumsum(sizes)])


def test_alpha_zero_gives_the_identity() -> None:
    """A task that nothing restricts is not projected."""
    jacobian, starts = _rows(np.random.default_rng(0), 7, [3, 2])
    projectors = generalized_projectors(jacobian, starts, np.zeros((2, 2)))
    assert np.array_equal(projectors, np.broadcast_to(np.eye(7), (2, 7, 7)))


def test_alpha_one_gives_the_null_space_projector() -> None:
    """alpha_ij = 1 alone: P_i = I - J_j^+ J_j, the classical projector."""
    jacobian, starts = _rows(np.random.default_rng(1), 9, [4, 3])
    projectors = generalized_projectors(jacobian, starts, np.array([[0.0, 0.0], [1.0, 0.0]]))
    upper = jacobian[:4]
    assert np.allclose(projectors[1], np.eye(9) - np.linalg.pinv(upper) @ upper, atol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_strict_tasks_are_not_moved_whatever_the_other_entries(seed: int) -> None:
    """J_j P_i = 0 for every j with alpha_ij = 1, beside entries between 0 and 1."""
    rng = np.random.default_rng(seed)
    k = 4
    jacobian, starts = _rows(rng, 12, [3, 2, 3, 2])
    alpha = random_alpha(rng, k)
    projectors = generalized_projectors(jacobian, starts, alpha)
    for i in range(k):
        assert np.allclose(projectors[i], projectors[i].T, atol=1e-13)
        eigenvalues = np.linalg.eigvalsh(projectors[i])
        assert eigenvalues[0] > -1e-12
        assert eigenvalues[-1] < 1.0 + 1e-12
        for j in np.flatnonzero(alpha[i] == 1.0):
            rows = jacobian[starts[j] : starts[j + 1]]
            assert np.abs(rows @ projectors[i]).max() < 1e-12


def test_a_row_of_ones_cancels_the_task() -> None:
    """alpha_ii = 1 with the whole row 1: the task's own rows give no motion."""
    jacobian, starts = _rows(np.random.default_rng(2), 8, [3, 3])
    alpha = np.array([[0.0, 0.0], [1.0, 1.0]])
    projector = generalized_projectors(jacobian, starts, alpha)[1]
    assert np.abs(jacobian[3:] @ projector).max() < 1e-12


def test_continuous_across_ties() -> None:
    """Lipschitz in alpha where two entries cross and the sorting changes."""
    rng = np.random.default_rng(3)
    jacobian, starts = _rows(rng, 7, [2, 2, 2])

    def at(shift: float) -> Array:
        alpha = np.zeros((3, 3))
        alpha[2] = [0.5 + shift, 0.5 - shift, 0.0]
        return generalized_projectors(jacobian, starts, alpha)[2]

    ratios = []
    for step in (1e-2, 1e-4, 1e-6, 1e-8):
        ratios.append(np.abs(at(step) - at(-step)).max() / (2.0 * step))
    assert max(ratios) < 4.0
    assert max(ratios) / min(ratios) < 1.01


@pytest.mark.parametrize("seed", range(5))
def test_lipschitz_on_random_ramps(seed: int) -> None:
    """Between any two matrices no small step of alpha makes a large step of P."""
    rng = np.random.default_rng(seed)
    jacobian, starts = _rows(rng, 10, [3, 3, 3, 10])
    start, goal = random_alpha(rng, 4), random_alpha(rng, 4)
    samples = [
        generalized_projectors(jacobian, starts, start + s * (goal - start))
        for s in np.linspace(0.0, 1.0, 401)
    ]
    steps = [np.abs(b - a).max() for a, b in pairwise(samples)]
    assert max(steps) < 4.0 / 400


def test_dependent_rows_count_once() -> None:
    """A row that repeats another one, up to rounding, adds no direction."""
    rng = np.random.default_rng(4)
    independent = rng.normal(size=(2, 7))
    jacobian = np.vstack([independent, independent.sum(axis=0), np.eye(7)])
    alpha = np.array([[0.0, 0.0], [1.0, 0.0]])
    projector = generalized_projectors(jacobian, np.array([0, 3, 10]), alpha)[1]
    exact = np.eye(7) - np.linalg.pinv(independent) @ independent
    assert np.abs(projector - exact).max() < 1e-12


def test_damped_layers_agree_and_bridge_rank_changes() -> None:
    """e -> 0 gives the exact form; at a rank change only the damped form is continuous."""
    rng = np.random.default_rng(5)
    jacobian, starts = _rows(rng, 7, [3, 2])
    alpha = np.array([[0.0, 0.0], [0.7, 0.2]])
    exact = generalized_projectors(jacobian, starts, alpha)
    damped = generalized_projectors(jacobian, starts, alpha, ProjectorSettings(layer_damping=1e-6))
    assert np.abs(exact - damped).max() < 1e-9

    direction, other = rng.normal(size=7), rng.normal(size=7)

    def bend(angle: float, damping: float) -> Array:
        rows = np.vstack([direction, direction + angle * other])
        settings = ProjectorSettings(layer_damping=damping)
        strict = np.array([[0.0, 0.0], [1.0, 0.0]])
        stacked = np.vstack([rows, np.eye(7)])
        return generalized_projectors(stacked, np.array([0, 2, 9]), strict, settings)[1]

    assert np.abs(bend(1e-6, 0.0) - bend(0.0, 0.0)).max() > 0.1
    assert np.abs(bend(1e-6, 1e-2) - bend(0.0, 1e-2)).max() < 1e-3


def test_smallest_singular_value() -> None:
    """1 or more with an identity projector, 0 when a direction is projected away for all."""
    rng = np.random.default_rng(6)
    jacobian, starts = _rows(rng, 6, [2, 2])
    free = generalized_projectors(jacobian, starts, strict_alpha(2))
    assert smallest_singular_value(free) > 1.0 - 1e-12
    blocked = generalized_projectors(jacobian, starts, np.ones((2, 2)))
    assert smallest_singular_value(blocked) < 1e-7


def test_damped_layers_do_not_depend_on_shared_bases() -> None:
    """Every P_i is that of its own row alone, by plain inverses: 20 problems of 4 tasks."""
    rng = np.random.default_rng(8)
    damping = 1e-2
    for _ in range(20):
        jacobian, starts = _rows(rng, 8, [2, 3, 2, 8])
        jacobian /= np.linalg.norm(jacobian, axis=1, keepdims=True)
        alpha = random_alpha(rng, 4)
        settings = ProjectorSettings(layer_damping=damping)
        projectors = generalized_projectors(jacobian, starts, alpha, settings)
        for i in range(4):
            order = np.argsort(-alpha[i], kind="stable")
            levels = np.append(alpha[i][order], 0.0)
            expected = np.eye(8)
            for last in range(4):
                tasks = order[: last + 1]
                stacked = np.vstack([jacobian[starts[j] : starts[j + 1]] for j in tasks])
                gram = stacked @ stacked.T + damping**2 * np.eye(len(stacked))
                share = levels[last] - levels[last + 1]
                expected -= share * stacked.T @ np.linalg.solve(gram, stacked)
            assert np.abs(projectors[i] - expected).max() < 1e-9

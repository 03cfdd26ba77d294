"""Formulation weighted: weights that stay solvable with many tasks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array


@pytest.mark.parametrize(("n", "share", "contacts"), [(32, 0.5, 0), (38, None, 4)])
def test_ten_levels_are_solved(n: int, share: float | None, contacts: int) -> None:
    """Ten strict levels, torque bounds active or in contact: all of 30 SOLVED, rows kept."""
    rng = np.random.default_rng(51)
    formulation = make_formulation("weighted")
    for _ in range(30):
        problem = random_problem(rng, n, [3] * 10, strict_alpha(10), share, contacts)
        solution = formulation.solve(problem)
        assert solution.status is SolutionStatus.SOLVED
        assert solution.qp_solved
        assert (solution.torque <= problem.torque.upper + 1e-6).all()
        assert (solution.torque >= problem.torque.lower - 1e-6).all()


def test_three_levels_keep_their_ratio() -> None:
    """Few tasks are weighted as before, 100 from level to level: each is met accordingly."""
    rng = np.random.default_rng(52)
    for _ in range(20):
        problem = random_problem(rng, 7, [3, 2, 7], strict_alpha(3))
        solution = make_formulation("weighted").solve(problem)
        weights = np.repeat([1e4, 1e2, 1.0], [3, 2, 7])
        rows = problem.jacobian * weights[:, None]
        normal = problem.jacobian.T @ rows + 1e-2 * np.eye(7)
        expected = np.linalg.solve(normal, rows.T @ problem.target)
        assert np.abs(solution.acceleration - expected).max() < 1e-7


def test_the_cap_sets_in_without_a_jump() -> None:
    """While a tenth task comes in, steps of the answer shrink with those of alpha."""
    rng = np.random.default_rng(53)
    start, goal = np.ones((10, 10)), strict_alpha(10)
    start[:9] = 0.0
    start[:9, :9] = strict_alpha(9)
    problem = random_problem(rng, 32, [3] * 10, start)
    formulation = make_formulation("weighted")

    def torque(s: float) -> Array:
        alpha = start + s * (goal - start)
        return formulation.solve(replace(problem, priorities=Priorities.of(alpha))).torque

    for s in (0.0, 0.5, 1.0 - 1e-4):
        steps = [np.abs(torque(s + h) - torque(s)).max() for h in (1e-4, 1e-6)]
        assert steps[1] < 0.1 * steps[0]

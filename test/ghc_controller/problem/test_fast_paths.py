"""Short cuts of the hot path give what the long way gives."""

from __future__ import annotations

import numpy as np
import pytest
from random_problems import random_alpha, random_problem, strict_alpha

from ghc_controller.core.native import cholesky, inverse_factor
from ghc_controller.formulations import ControlProblem, make_formulation
from ghc_controller.hierarchy import generalized_projectors
from ghc_controller.qp import QpProblem, make_solver, residuals
from ghc_controller.qp.daqp_solver import DaqpSolver
from ghc_controller.qp.solver import SolverSettings
from ghc_controller.types import Array


def _layer_cake(jacobian: Array, starts: Array, alpha_row: Array) -> Array:
    """P = I - sum_l (a_(l) - a_(l+1)) Pi_l by pseudoinverses, one task after the other."""
    n = jacobian.shape[1]
    order = np.argsort(-alpha_row, kind="stable")
    projector = np.eye(n)
    stacked = np.zeros((0, n))
    for level, task in enumerate(order):
        stacked = np.vstack([stacked, jacobian[starts[task] : starts[task + 1]]])
        following = alpha_row[order[level + 1]] if level + 1 < len(order) else 0.0
        projector -= (alpha_row[task] - following) * np.linalg.pinv(stacked) @ stacked
    return projector


@pytest.mark.parametrize("seed", range(20))
def test_shared_basis_and_full_posture_give_the_same_projectors(seed: int) -> None:
    """Any priorities, with a task of all joints among the others."""
    rng = np.random.default_rng(seed)
    n, k = 9, 5
    jacobian = np.vstack([rng.normal(size=(2, n)), np.eye(n), rng.normal(size=(6, n))])
    starts = np.array([0, 2, 2 + n, 5 + n, 7 + n, 8 + n])
    alpha = random_alpha(rng, k) if seed % 2 else strict_alpha(k)[rng.permutation(k)]
    projectors = generalized_projectors(jacobian, starts, alpha)
    for i in range(k):
        assert np.abs(projectors[i] - _layer_cake(jacobian, starts, alpha[i])).max() < 1e-11


@pytest.mark.parametrize("n", [1, 3, 7, 32])
def test_factors(n: int) -> None:
    """L L^T = A and F F^T = A^-1; a singular matrix is no exception."""
    root = np.random.default_rng(n).normal(size=(n, n))
    matrix = root @ root.T + 0.1 * np.eye(n)
    assert np.allclose(cholesky(matrix), np.linalg.cholesky(matrix), atol=1e-12)
    factor = inverse_factor(matrix)
    assert np.allclose(factor @ factor.T @ matrix, np.eye(n), atol=1e-9)
    assert np.isfinite(cholesky(np.zeros((n, n)))).all()


def test_daqp_from_the_last_active_set_gives_the_same_answer() -> None:
    """On a walk of problems with many active rows, with jumps in between."""
    rng = np.random.default_rng(1)
    settings = SolverSettings()
    warm = DaqpSolver(settings)
    n = 25
    rows, wish = rng.normal(size=(2 * n, n)), rng.normal(size=2 * n)
    many = 0
    for index in range(60):
        step = 1.0 if index % 20 == 0 else 1e-2
        rows, wish = (
            rows + step * rng.normal(size=rows.shape),
            wish + step * rng.normal(size=2 * n),
        )
        lower = 3.0 * wish - 1.5
        problem = QpProblem(
            np.eye(n), np.zeros(n), np.zeros((0, n)), np.zeros(0), rows, lower, lower + 60.0
        )
        cold_answer, warm_answer = DaqpSolver(settings).solve(problem), warm.solve(problem)
        assert warm_answer.status is cold_answer.status
        if cold_answer.found:
            assert np.abs(warm_answer.x - cold_answer.x).max() < 1e-9 * np.abs(cold_answer.x).max()
            assert residuals(problem, warm_answer).small
            many += int(np.count_nonzero(cold_answer.z) > 10)
    assert many > 30


def test_residuals_of_a_broken_answer_are_not_small() -> None:
    """NaN in, no trust out."""
    problem = QpProblem(
        np.eye(2), np.zeros(2), np.zeros((0, 2)), np.zeros(0), np.eye(2), -np.ones(2), np.ones(2)
    )
    result = make_solver("daqp").solve(problem)
    assert residuals(problem, result).small
    result.x[0] = np.nan
    assert not residuals(problem, result).small


def test_a_read_only_alpha_is_taken() -> None:
    """The core takes it as it is."""
    rng = np.random.default_rng(2)
    alpha = strict_alpha(2)
    alpha.setflags(write=False)
    problem: ControlProblem = random_problem(rng, 7, [3, 3], alpha)
    assert np.array_equal(problem.alpha, alpha)
    assert make_formulation("ghc").solve(problem).acceleration.shape == (7,)

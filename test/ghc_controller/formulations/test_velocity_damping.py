"""Damping towards -kd v: accelerations that no task claims bring the joints to rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import ControlProblem, FormulationSettings, make_formulation
from ghc_controller.hierarchy import Priorities, matrix_from_hierarchy
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.types import Array

KD = 20.0  # [1/s]
W = 1e-2
DAMPED = ("balanced", "ghc", "ghc_full", "weighted")


def _moving(rng: np.random.Generator, sizes: list[int], alpha: Array) -> ControlProblem:
    problem = random_problem(rng, 7, sizes, alpha)
    return replace(problem, velocity=0.1 * rng.normal(size=7))


def _optimum(problem: ControlProblem, kd: float) -> Array:
    """Least |J x - b|^2 + w |x + kd v|^2."""
    jacobian = problem.jacobian
    right = jacobian.T @ problem.target - W * kd * problem.velocity
    hessian = jacobian.T @ jacobian + W * np.eye(7)
    return np.asarray(np.linalg.solve(hessian, right), dtype=np.float64)


@pytest.mark.parametrize("name", DAMPED)
def test_one_task_is_damped_towards_rest(name: str) -> None:
    """x minimizes |J x - b|^2 + w |x + kd v|^2: 20 problems."""
    rng = np.random.default_rng(31)
    settings = FormulationSettings(regularization=W, velocity_damping=KD)
    for _ in range(20):
        problem = _moving(rng, [3], np.zeros((1, 1)))
        x = make_formulation(name, settings).solve(problem).acceleration
        assert np.abs(x - _optimum(problem, KD)).max() < 1e-8


@pytest.mark.parametrize("name", DAMPED)
def test_unclaimed_motions_are_braked(name: str) -> None:
    """Outside the rows of all tasks x = -kd v, whatever their order; 20 problems."""
    rng = np.random.default_rng(32)
    for _ in range(20):
        problem = _moving(rng, [2, 2], strict_alpha(2))
        x = make_formulation(name).solve(problem).acceleration
        free = np.linalg.svd(problem.jacobian)[2][4:]
        assert np.abs(free @ (x + KD * problem.velocity)).max() < 1e-7


@pytest.mark.parametrize("name", DAMPED)
def test_without_velocity_damping_only_the_tasks_count(name: str) -> None:
    """velocity_damping = 0 is the form of the literature: v does not enter."""
    rng = np.random.default_rng(33)
    settings = FormulationSettings(velocity_damping=0.0)
    problem = _moving(rng, [3, 7], strict_alpha(2))
    still = replace(problem, velocity=np.zeros(7))
    formulation = make_formulation(name, settings)
    a, b = formulation.solve(problem), formulation.solve(still)
    assert np.array_equal(a.acceleration, b.acceleration)


def test_the_balance_follows_the_damped_cascade() -> None:
    """balanced = hqp damped alike, to what the layers leak; three levels, 50 problems."""
    rng = np.random.default_rng(34)
    cascade = make_formulation("hqp", FormulationSettings(hqp_damps_velocity=True))
    for _ in range(50):
        problem = _moving(rng, [2, 2, 7], strict_alpha(3))
        a = make_formulation("balanced").solve(problem).acceleration
        b = cascade.solve(problem).acceleration
        assert np.abs(a - b).max() < 1e-5


def test_hqp_damps_as_the_literature_unless_told_otherwise() -> None:
    """With one task: towards 0, or towards -kd v by the option."""
    problem = _moving(np.random.default_rng(35), [3], np.zeros((1, 1)))
    for option, kd in ((False, 0.0), (True, KD)):
        settings = FormulationSettings(regularization=W, hqp_damps_velocity=option)
        x = make_formulation("hqp", settings).solve(problem).acceleration
        assert np.abs(x - _optimum(problem, kd)).max() < 1e-8


@pytest.mark.parametrize("name", DAMPED)
def test_a_removed_task_is_braked_too(name: str) -> None:
    """A task that is out leaves its directions to the damping."""
    rng = np.random.default_rng(36)
    alpha = matrix_from_hierarchy(("a", "b"), "a").alpha
    problem = _moving(rng, [3, 2], alpha)
    alone = replace(
        problem,
        jacobian=problem.jacobian[:3],
        target=problem.target[:3],
        starts=problem.starts[:2],
        priorities=Priorities.of(np.zeros((1, 1))),
    )
    x = make_formulation(name).solve(problem).acceleration
    assert np.abs(x - make_formulation(name).solve(alone).acceleration).max() < 1e-9


def test_the_pull_keeps_the_contacts() -> None:
    """In contact y_0 is the acceleration nearest to -kd v among those that keep them."""
    rng = np.random.default_rng(37)
    problem = random_problem(rng, 24, [3], np.zeros((1, 1)), contacts=4)
    problem = replace(problem, velocity=rng.normal(size=24))
    reduced = reduce_contacts(problem)
    origin, left = reduced.about_rest(KD)
    assert reduced.basis is not None
    apart = reduced.accelerations(origin) + KD * problem.velocity
    assert np.abs(reduced.basis.T @ apart).max() < 1e-9 * np.abs(apart).max()
    assert np.allclose(left, reduced.target - reduced.jacobian @ origin)


def test_a_negative_damping_is_refused() -> None:
    """It would drive the joints."""
    with pytest.raises(InvalidValue, match="velocity_damping: a number >= 0 expected, -1"):
        FormulationSettings(velocity_damping=-1.0)

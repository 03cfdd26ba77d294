"""ghc in the metrics of inertia and torque: dynamically consistent projectors, and bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_alpha, random_problem, strict_alpha

from ghc_controller.formulations import (
    ControlProblem,
    FormulationSettings,
    Metric,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.hierarchy.projector import generalized_projectors
from ghc_controller.types import Array

METRICS = (Metric.INERTIA, Metric.TORQUE)
SEED = 12


def _solve(problem: ControlProblem, metric: Metric, w: float = 1e-2) -> Array:
    settings = FormulationSettings(regularization=w, velocity_damping=0.0, metric=metric)
    return make_formulation("ghc", settings).solve(problem).acceleration


def _weight(problem: ControlProblem, metric: Metric) -> Array:
    """W of the metric, scaled to trace n."""
    mass = problem.mass_matrix
    weight = mass if metric is Metric.INERTIA else mass @ mass
    return weight * (len(mass) / np.trace(weight))


@pytest.mark.parametrize("metric", METRICS)
def test_without_bounds_it_is_the_closed_form_of_that_metric(metric: Metric) -> None:
    """x = sum P_i W^-1 J_i^T (J_i W^-1 J_i^T + w)^-1 b_i for any alpha, to 1e-7: 30 problems."""
    rng = np.random.default_rng(SEED)
    for _ in range(30):
        problem = random_problem(rng, 12, [2, 3, 2], random_alpha(rng, 3))
        weight = _weight(problem, metric)
        lower = np.linalg.cholesky(weight)
        rows = problem.jacobian @ np.linalg.inv(lower).T
        projectors = generalized_projectors(rows, problem.starts, problem.alpha)
        x = np.zeros(12)
        for i, projector in enumerate(projectors):
            part = slice(problem.starts[i], problem.starts[i + 1])
            gram = rows[part] @ rows[part].T + 1e-2 * np.eye(rows[part].shape[0])
            own = rows[part].T @ np.linalg.solve(gram, problem.target[part])
            x += np.linalg.solve(lower.T, projector @ own)
        found = _solve(problem, metric)
        assert np.abs(found - x).max() < 1e-7 * max(1.0, np.abs(x).max())


def test_torques_of_a_lower_task_do_not_accelerate_those_above_it() -> None:
    """A change of its target moves no row above; in the metric M its torques are M P_i M^-1."""
    rng = np.random.default_rng(SEED)
    for metric in METRICS:
        problem = random_problem(rng, 12, [2, 3, 2], strict_alpha(3))
        target = problem.target.copy()
        target[5:] += 3.0
        change = _solve(replace(problem, target=target), metric) - _solve(problem, metric)
        assert np.abs(problem.jacobian[:5] @ change).max() < 1e-8
        assert np.abs(change).max() > 1e-2


def test_projectors_of_the_metric_of_inertia_are_dynamically_consistent() -> None:
    """P M^-1 = M^-1 P^T, which orthogonal projectors do not meet: J_j M^-1 (M P M^-1) = 0."""
    rng = np.random.default_rng(SEED)
    problem = random_problem(rng, 12, [2, 3, 2], strict_alpha(3))
    mass = problem.mass_matrix
    lower = np.linalg.cholesky(mass)
    back = np.linalg.inv(lower).T
    rows = problem.jacobian @ back
    inner = generalized_projectors(rows, problem.starts, problem.alpha)[2]
    projector = back @ inner @ lower.T
    inverse = np.linalg.inv(mass)
    assert np.abs(projector @ inverse - inverse @ projector.T).max() < 1e-10
    torque_projector = mass @ projector @ inverse
    assert np.abs(problem.jacobian[:5] @ inverse @ torque_projector).max() < 1e-10
    plain = generalized_projectors(problem.jacobian, problem.starts, problem.alpha)[2]
    assert np.abs(problem.jacobian[:5] @ inverse @ plain).max() > 1e-3


@pytest.mark.parametrize("metric", METRICS)
def test_with_bounds_it_is_the_qp_of_eq_13_in_that_metric(metric: Metric) -> None:
    """The same answer as for a problem written in z = W^1/2 x with M W^-1/2: 40 problems, 1e-6."""
    rng = np.random.default_rng(SEED)
    bounded = 0
    formulation = make_formulation("ghc", FormulationSettings(velocity_damping=0.0, metric=metric))
    plain = make_formulation("ghc", FormulationSettings(velocity_damping=0.0))
    for _ in range(40):
        problem = random_problem(rng, 9, [3, 2, 3], strict_alpha(3), torque_share=0.5)
        root = np.linalg.inv(np.linalg.cholesky(_weight(problem, metric))).T
        moved = replace(
            problem, jacobian=problem.jacobian @ root, mass_matrix=problem.mass_matrix @ root
        )
        a, b = formulation.solve(problem), plain.solve(moved)
        assert a.status is b.status is SolutionStatus.SOLVED
        bounded += a.qp_solved
        assert np.abs(a.torque - b.torque).max() < 1e-6
    assert bounded > 0

"""Formulation hqp: contact forces do not cost task error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.formulations import ControlProblem, SolutionStatus, make_formulation
from ghc_controller.formulations.cascade.force_center import balanced_contacts
from ghc_controller.hierarchy import Priorities


def _at_rest(rng: np.random.Generator, levels: int) -> ControlProblem:
    """Standing with every task at its reference and contacts that do not slide: b = 0."""
    problem = random_problem(rng, 24, [3] * levels, strict_alpha(levels), contacts=4)
    assert problem.contacts is not None
    still = problem.contacts._replace(drift_target=np.zeros(12))
    return replace(problem, target=np.zeros(3 * levels), contacts=still)


@pytest.mark.parametrize("levels", [1, 3])
def test_standing_without_task_errors_asks_for_nothing(levels: int) -> None:
    """x = 0 to 1e-6 rad/s^2, whatever forces the cost prefers: 20 problems."""
    rng = np.random.default_rng(61)
    for _ in range(20):
        solution = make_formulation("hqp").solve(_at_rest(rng, levels))
        assert solution.status is SolutionStatus.SOLVED
        assert np.abs(solution.acceleration).max() < 1e-6


def test_forces_are_those_of_least_cost() -> None:
    """Where no bound is active they minimize (f - f_0)^T H (f - f_0) for their accelerations."""
    rng = np.random.default_rng(62)
    seen = 0
    for _ in range(20):
        problem = _at_rest(rng, 2)
        solution = make_formulation("hqp").solve(problem)
        if solution.qp_solved:
            continue
        seen += 1
        _, forces = balanced_contacts(problem)
        assert problem.contacts is not None
        pull = np.linalg.inv(problem.contacts.force_factor)
        gradient = pull.T @ pull @ (solution.force - problem.contacts.force_center)
        assert np.abs(forces.free.T @ gradient).max(initial=0.0) < 1e-9
    assert seen > 0


def test_force_bounds_reach_the_tasks_in_their_order() -> None:
    """With friction rows active the first task is met as without the tasks below: 20 problems."""
    rng = np.random.default_rng(63)
    active = 0
    for _ in range(20):
        problem = random_problem(rng, 24, [3, 3], strict_alpha(2), contacts=4)
        problem = replace(problem, target=200.0 * problem.target)
        alone = replace(
            problem,
            jacobian=problem.jacobian[:3],
            target=problem.target[:3],
            starts=problem.starts[:2],
            priorities=Priorities.of(np.zeros((1, 1))),
        )
        both, first = (make_formulation("hqp").solve(each) for each in (problem, alone))
        active += first.qp_solved
        missed = [
            np.linalg.norm(alone.jacobian @ each.acceleration - alone.target)
            for each in (both, first)
        ]
        assert missed[0] < missed[1] + 1e-4 * (1.0 + np.linalg.norm(alone.target))
    assert active > 0

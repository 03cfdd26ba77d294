"""Soft rows give way by the least that is needed, in physical units, before tasks are weighed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hard_problems import violation
from random_problems import random_problem, strict_alpha
from scipy.optimize import nnls

from ghc_controller.formulations import (
    FORMULATIONS,
    AccelerationRows,
    ControlProblem,
    FormulationSettings,
    Solution,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.hierarchy import Priorities
from ghc_controller.qp import QpProblem, QpResult, QpStatus, SolverSettings
from ghc_controller.qp.daqp_solver import DaqpSolver
from ghc_controller.qp.dual_solver import DualSolver
from ghc_controller.qp.fallback import Fallback
from ghc_controller.types import Array, Bounds

_ACTIVE = 1e-4  # [Nm] a torque so near its limit is at it: bounds are widened by 1e-7 rad/s^2


def _solve(name: str, problem: ControlProblem) -> Solution:
    return make_formulation(name, FormulationSettings()).solve(problem)


def _one_joint_too_weak() -> ControlProblem:
    """Two joints of 1 kg m^2 that can do 3.1 rad/s^2; the box of the first begins at 10 rad/s^2.

    The task pulls the first joint back with 500 rad/s^2.
    """
    torque = Bounds(np.full(2, -3.1), np.full(2, 3.1))
    box = Bounds(np.array([10.0, -5.0]), np.array([12.0, 5.0]))
    starts = np.array([0, 2])
    target = np.array([-500.0, 1.0])
    alone, still = Priorities.of(np.zeros((1, 1))), np.zeros(2)
    return ControlProblem(
        np.eye(2), target, starts, alone, np.eye(2), still, still, box, torque, torque
    )


@pytest.mark.parametrize("name", FORMULATIONS)
def test_no_more_than_needed(name: str) -> None:
    """6.9 rad/s^2 suffice, 6.9 are taken, whatever the task asks for; the second joint is free."""
    solution = _solve(name, _one_joint_too_weak())
    assert solution.status is SolutionStatus.RELAXED
    assert solution.acceleration_slack is not None
    assert np.abs(solution.acceleration_slack - [6.9, 0.0]).max() < 1e-6
    assert abs(solution.acceleration[1] - 1.0) < 0.05


@pytest.mark.parametrize("name", FORMULATIONS)
def test_the_slack_is_the_least_sum_of_squares(name: str) -> None:
    """At the least slack d of boxes on x, M^T l = d with l in the cone of the torques at a limit.

    40 problems of 7 joints, seed 3; the cone is searched by NNLS. No torque exceeds its limit.
    """
    rng = np.random.default_rng(3)
    for _ in range(40):
        n = 7
        problem = random_problem(rng, n, [3, n], strict_alpha(2), rng.uniform(0.05, 0.5))
        lower = 20.0 * rng.normal(size=n)
        problem = replace(problem, acceleration=Bounds(lower, lower + rng.uniform(0.0, 5.0, n)))
        solution = _solve(name, problem)
        assert solution.status is SolutionStatus.RELAXED
        assert violation(problem, solution.acceleration, solution.torque, soft=False) < 1e-6
        assert _distance_to_cone(problem, solution) < 1e-5


def _distance_to_cone(problem: ControlProblem, solution: Solution) -> float:
    """Relative distance of the signed slack from what torques at their limits can hold."""
    x, tau, box = solution.acceleration, solution.torque, problem.acceleration
    slack = np.maximum(box.lower - x, 0.0) - np.maximum(x - box.upper, 0.0)
    at_upper = tau > problem.torque.upper - _ACTIVE
    at_lower = tau < problem.torque.lower + _ACTIVE
    cone = np.vstack([problem.mass_matrix[at_upper], -problem.mass_matrix[at_lower]]).T
    return float(nnls(cone, slack)[1] / np.linalg.norm(slack))


@pytest.mark.parametrize("name", FORMULATIONS)
def test_general_rows_share_the_slack(name: str) -> None:
    """Two rows that exclude each other by 4 give way by 2 each."""
    problem = _one_joint_too_weak()
    rows = AccelerationRows(
        np.array([[1.0, 0.0], [1.0, 0.0]]),
        np.array([2.0, -np.inf]),
        np.array([np.inf, -2.0]),
        ("ahead", "back"),
    )
    problem = replace(problem, acceleration=Bounds(np.full(2, -9.0), np.full(2, 9.0)), rows=rows)
    solution = _solve(name, problem)
    assert solution.status is SolutionStatus.RELAXED
    assert solution.rows_slack is not None
    assert np.abs(solution.rows_slack - 2.0).max() < 1e-6
    assert solution.acceleration_slack is None


class _Never(DaqpSolver):
    """Reports a conflict for whatever it is given."""

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        return super().run(problem, limit)._replace(status=QpStatus.INFEASIBLE)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_nothing_gives_way_on_a_word(name: str) -> None:
    """A first solver that always reports a conflict relaxes nothing where x = 0 is feasible."""
    rng = np.random.default_rng(12)
    settings = SolverSettings()
    solver = Fallback(_Never(settings), DualSolver(settings), settings)
    formulation = make_formulation(name, FormulationSettings(), solver)
    for _ in range(30):
        problem = random_problem(rng, 7, [3, 7], strict_alpha(2), torque_share=0.5)
        solution = formulation.solve(replace(problem, acceleration=_box(rng, 7)))
        assert solution.status is SolutionStatus.SOLVED
        assert solution.violation <= 1e-6


def _box(rng: np.random.Generator, n: int) -> Bounds:
    size: Array = 10.0 ** rng.uniform(0.0, 1.5, n)
    return Bounds(-size, size)


@pytest.mark.parametrize("name", FORMULATIONS)
def test_the_rate_gives_way_only_after_soft_rows(name: str) -> None:
    """A box of torque limit and rate that no row needs more of keeps the rate."""
    problem = _one_joint_too_weak()
    wide = Bounds(np.full(2, -50.0), np.full(2, 50.0))
    solution = _solve(name, replace(problem, torque_limit=wide))
    assert not solution.rate_gave_way
    assert np.abs(solution.torque).max() <= 3.1 + 1e-6


@pytest.mark.parametrize("name", FORMULATIONS)
def test_bounds_that_cross_are_met_half_way(name: str) -> None:
    """A row from 4 up to -2 rad/s^2 gives way by 3 on both sides."""
    problem = _one_joint_too_weak()
    box = Bounds(np.array([4.0, -5.0]), np.array([-2.0, 5.0]))
    solution = _solve(name, replace(problem, acceleration=box))
    assert solution.status is SolutionStatus.RELAXED
    assert abs(solution.acceleration[0] - 1.0) < 1e-6
    assert solution.acceleration_slack is not None
    assert np.abs(solution.acceleration_slack - [3.0, 0.0]).max() < 1e-6


@pytest.mark.parametrize("name", FORMULATIONS)
def test_force_bounds_give_way_last_and_least(name: str) -> None:
    """A contact asked for at least 60 N and at most 40 N gets 50 N; no other row gives way.

    Four point contacts of a floating base, seed 2. Balance, cones and torque box are kept.
    """
    problem = random_problem(np.random.default_rng(2), 18, [3, 18], strict_alpha(2), contacts=4)
    contacts = problem.contacts
    assert contacts is not None
    normal = np.zeros((2, 12))
    normal[:, 2] = 1.0
    bounds = contacts._replace(
        force_matrix=np.vstack([normal, contacts.force_matrix]),
        force_lower=np.concatenate([[60.0, -np.inf], contacts.force_lower]),
        force_upper=np.concatenate([[np.inf, 40.0], contacts.force_upper]),
        names=("least", "most", *contacts.names),
        bounds=2,
    )
    solution = _solve(name, replace(problem, contacts=bounds))
    assert solution.status is SolutionStatus.RELAXED
    assert solution.force_slack is not None
    assert np.abs(solution.force_slack[:2] - 10.0).max() < 1e-5
    assert solution.force_slack[2:].max() < 1e-6
    assert solution.acceleration_slack is None
    assert np.abs(_imbalance(problem, solution)).max() < 1e-6


def _imbalance(problem: ControlProblem, solution: Solution) -> Array:
    """(n,) M x + h - [0; tau] - J_f^T f."""
    assert problem.contacts is not None
    torque = np.concatenate([np.zeros(problem.unactuated), solution.torque])
    given = torque + problem.contacts.force_jacobian.T @ solution.force
    return problem.mass_matrix @ solution.acceleration + problem.bias - given

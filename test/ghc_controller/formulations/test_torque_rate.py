"""The torque rate limit of the cascade: met once, by the answer of all levels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_controller.hierarchy import Candidate, Priorities
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.violation import largest_violation
from ghc_controller.types import Array, Bounds


def _problem(seed: int, contacts: int = 0) -> ControlProblem:
    n = 20 if contacts else 7
    return random_problem(
        np.random.default_rng(seed), n, [3, 2, n], strict_alpha(3), 0.6, contacts
    )


def _limited(problem: ControlProblem, about: Array, reach: float) -> ControlProblem:
    """Torques may lie within `reach` [Nm] of `about` (a,), and within their limits."""
    limit = problem.torque_limit
    near = Bounds(
        np.clip(about - reach, limit.lower, limit.upper),
        np.clip(about + reach, limit.lower, limit.upper),
    )
    return replace(problem, torque=near)


@pytest.mark.parametrize("contacts", [0, 4])
def test_an_answer_within_the_rate_is_that_of_the_levels(contacts: int) -> None:
    """Twenty problems with active torque limits, seeds 0 to 19."""
    formulation = make_formulation("cascade")
    for seed in range(20):
        problem = _problem(seed, contacts)
        wanted = formulation.solve(problem)
        found = formulation.solve(_limited(problem, wanted.torque, 1e-6))
        assert found.status is wanted.status
        assert np.array_equal(found.torque, wanted.torque, equal_nan=True)


@pytest.mark.parametrize("contacts", [0, 4])
def test_beyond_it_every_bound_holds_and_the_first_task_comes_nearest(contacts: int) -> None:
    """The torque of the step before is far away: the answer goes towards that of the levels.

    Among all that one period allows, the first task is met as nearly as weights of 1000 do: its
    error along the way is at most 1 % above that of a QP for it alone. Seeds 0 to 19.
    """
    formulation, rng = make_formulation("cascade"), np.random.default_rng(4)
    alone = make_formulation("hqp")
    for seed in range(20):
        problem = _problem(seed, contacts)
        wanted = formulation.solve(problem)
        before = wanted.torque + rng.normal(size=wanted.torque.shape)
        limited = _limited(problem, before, 0.3)
        found = formulation.solve(limited)
        if found.status is not SolutionStatus.SOLVED:
            assert contacts  # a base that needs other torques at once
            continue
        assert (found.torque >= limited.torque.lower - 1e-6).all()
        assert (found.torque <= limited.torque.upper + 1e-6).all()
        violation = largest_violation(
            limited, found.acceleration, found.force, found.torque, limited.torque
        )
        assert violation <= 1e-6
        rows, target = problem.jacobian[:3], problem.jacobian[:3] @ wanted.acceleration
        first = replace(
            limited,
            jacobian=rows,
            target=target,
            starts=np.array([0, 3], dtype=np.int64),
            priorities=Priorities.of(np.zeros((1, 1))),
        )
        best = alone.solve(first)
        error = np.linalg.norm(rows @ found.acceleration - target)
        least = np.linalg.norm(rows @ best.acceleration - target)
        assert error <= 1.01 * least + 0.05


def test_torques_do_not_jump_where_the_rate_begins_to_hold() -> None:
    """The box moves over the answer in steps of 1e-3 Nm: no torque moves by more than the box."""
    formulation = make_formulation("cascade")
    for seed in range(5):
        problem = _problem(seed)
        wanted = formulation.solve(problem)
        previous: Array | None = None
        for shift in np.arange(0.15, 0.25, 1e-3):
            about = wanted.torque + shift
            torque = formulation.solve(_limited(problem, about, 0.2)).torque
            if previous is not None:
                assert np.abs(torque - previous).max() < 5e-3
            previous = torque


def test_a_blend_meets_it_too() -> None:
    problem = _problem(3)
    forward = strict_alpha(3)
    backward = forward[::-1, ::-1].copy()
    mixture = Priorities.mixed((Candidate(forward, 0.5), Candidate(backward, 0.5)))
    about = problem.bias.copy()
    limited = replace(_limited(problem, about, 0.1), priorities=mixture)
    found = make_formulation("cascade").solve(limited)
    assert found.status is SolutionStatus.SOLVED
    assert np.abs(found.torque - about).max() <= 0.1 + 1e-6

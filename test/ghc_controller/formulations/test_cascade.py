"""The smooth cascade: free and bounded answers, blends, flight, capped steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.core import level_damping
from ghc_controller.formulations import (
    ControlProblem,
    FormulationSettings,
    Solution,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.hierarchy import Candidate, Priorities, matrix_from_hierarchy
from ghc_controller.problem.violation import largest_violation
from ghc_controller.qp import SolverSettings, make_solver
from ghc_controller.types import Array, Bounds

TASKS = ("a", "b", "c")
W = 1e-2


def _solve(problem: ControlProblem) -> Solution:
    return make_formulation("cascade").solve(problem)


def _with(problem: ControlProblem, alpha: Array) -> ControlProblem:
    return replace(problem, priorities=Priorities.of(alpha))


def _violation(problem: ControlProblem, solution: Solution) -> float:
    answer = (solution.acceleration, solution.force, solution.torque)
    return largest_violation(problem, *answer, problem.torque)


def test_nothing_jumps_where_a_bound_becomes_active() -> None:
    """The torque box closes in 200 and in 1600 steps: these are at most a quarter as large.

    10 problems, seed 2; the first answers need no QP, the last ones several.
    """
    rng = np.random.default_rng(2)
    formulation = make_formulation("cascade")
    for _ in range(10):
        problem = random_problem(rng, 7, [3, 2, 7], strict_alpha(3))
        free = formulation.solve(problem)
        assert not free.qp_solved
        reach = np.abs(free.torque - problem.bias).max()
        largest = []
        for count in (200, 1600):
            answers = []
            for share in np.linspace(1.2, 0.2, count + 1):
                box = Bounds(problem.bias - share * reach, problem.bias + share * reach)
                answers.append(formulation.solve(replace(problem, torque=box, torque_limit=box)))
            assert not answers[0].qp_solved
            assert answers[-1].qp_solved
            assert all(answer.status is SolutionStatus.SOLVED for answer in answers)
            steps = np.diff([answer.torque for answer in answers], axis=0)
            largest.append(np.abs(steps).max())
        assert largest[1] < 0.25 * largest[0]


def test_a_mixture_is_the_mean_of_its_orders() -> None:
    """Torques and accelerations are linear in the shares, under active bounds; seed 3."""
    rng = np.random.default_rng(3)
    orders = ["a > b > c", "b > a > c", "c > a"]
    for contacts in (0, 4):
        problem = random_problem(
            rng, 26, [3, 2, 7], strict_alpha(3), None if contacts else 0.6, contacts
        )
        matrices = [matrix_from_hierarchy(TASKS, order).alpha for order in orders]
        alone = [_solve(_with(problem, alpha)) for alpha in matrices]
        shares = [0.5, 0.2, 0.3]
        mixture = Priorities.mixed(
            Candidate(alpha, share) for alpha, share in zip(matrices, shares, strict=True)
        )
        found = _solve(replace(problem, priorities=mixture))
        for name in ("acceleration", "torque", "force"):
            mean = sum(
                share * getattr(one, name) for share, one in zip(shares, alone, strict=True)
            )
            assert np.abs(getattr(found, name) - mean).max(initial=0.0) < 1e-9
        assert found.qp_solved == any(one.qp_solved for one in alone)
        if all(one.status is SolutionStatus.SOLVED for one in alone):
            assert _violation(problem, found) < 1e-6


def test_a_matrix_that_is_no_order_is_answered_by_balanced() -> None:
    """A compromise across levels, alone and as a part of a mixture."""
    rng = np.random.default_rng(4)
    problem = random_problem(rng, 7, [3, 2, 7], strict_alpha(3), 0.7)
    part = strict_alpha(3)
    part[2, 0] = 0.4
    found = _solve(_with(problem, part))
    expected = make_formulation("balanced").solve(_with(problem, part))
    assert np.array_equal(found.torque, expected.torque)
    mixture = Priorities.mixed((Candidate(part, 0.25), Candidate(strict_alpha(3), 0.75)))
    mixed = _solve(replace(problem, priorities=mixture))
    mean = 0.25 * found.torque + 0.75 * _solve(problem).torque
    assert np.abs(mixed.torque - mean).max() < 1e-9


@pytest.mark.parametrize("contacts", [0, 1, 2])
def test_flight_and_contacts_too_few_to_balance(contacts: int) -> None:
    """A floating base without a contact, on one point and on two: the base's motion is physical.

    What the contacts cannot carry is free fall; 20 problems each, seed 5.
    """
    rng = np.random.default_rng(5)
    for _ in range(20):
        problem = random_problem(rng, 20, [3, 3, 14], strict_alpha(3), contacts=max(contacts, 1))
        if contacts == 0:
            problem = replace(problem, contacts=None)
        elif problem.contacts is not None:  # forces of any sign: few points seldom carry a load
            free = np.full(problem.contacts.force_upper.shape, np.inf)
            problem = replace(problem, contacts=problem.contacts._replace(force_upper=free))
        found = _solve(problem)
        assert found.status is SolutionStatus.SOLVED
        assert _violation(problem, found) < 1e-6
        base = problem.mass_matrix[:6] @ found.acceleration + problem.bias[:6]
        if problem.contacts is not None:
            base -= problem.contacts.force_jacobian.T[:6] @ found.force
        assert np.abs(base).max() < 1e-6


def test_without_a_task_the_robot_is_braked() -> None:
    """x = -kd v, and inside the bounds as near to it as they allow."""
    rng = np.random.default_rng(6)
    removed = np.ones((2, 2))
    problem = random_problem(rng, 7, [3, 2], removed)
    velocity = rng.normal(size=7)
    problem = replace(problem, velocity=velocity)
    kd = FormulationSettings().velocity_damping
    assert np.abs(_solve(problem).acceleration + kd * velocity).max() < 1e-9
    box = Bounds(np.full(7, -3.0), np.full(7, 3.0))
    found = _solve(replace(problem, acceleration=box))
    assert np.abs(found.acceleration - np.clip(-kd * velocity, -3.0, 3.0)).max() < 1e-6


def test_a_task_of_short_rows_keeps_its_gains() -> None:
    """Rows of a fifth of their length: missed by less than half of what damping by w would."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        problem = random_problem(rng, 7, [3], np.zeros((1, 1)))
        J, b = 0.1 * problem.jacobian, 0.1 * problem.target
        found = _solve(replace(problem, jacobian=J, target=b)).acceleration
        damped = J.T @ np.linalg.solve(J @ J.T + W * np.eye(3), b)
        assert np.linalg.norm(J @ found - b) < 0.5 * np.linalg.norm(J @ damped - b)


def test_the_damping_is_continuous_and_between_its_limits() -> None:
    """Along rows that shrink, and along rows that levels above take: at most w + 4 w."""
    rng = np.random.default_rng(8)
    rows, residual = rng.normal(size=(3, 7)), 30.0 * rng.normal(size=3)
    zero = np.zeros(3)
    for scale in np.logspace(-12, 1, 200):
        kept = level_damping(scale * rows, scale * rows, zero, W)
        more = level_damping(1.01 * scale * rows, 1.01 * scale * rows, zero, W)
        assert 0.0 < kept <= W
        assert abs(more - kept) <= 0.011 * kept
    for share in np.linspace(0.0, 1.0, 101):
        left = level_damping(rows, share * rows, residual, W)
        assert 0.0 < left <= 5.0 * W + 1e-15
    assert level_damping(rows, rows, residual, W) == level_damping(rows, rows, zero, W)


def test_a_step_without_pivots_keeps_the_levels_that_it_had() -> None:
    """Few pivots a step: feasible answers, counted, the first level as with all of them."""
    rng = np.random.default_rng(9)
    short = make_formulation(
        "cascade", solver=make_solver("daqp", SolverSettings(max_step_pivots=12))
    )
    capped = 0
    for _ in range(60):
        problem = random_problem(rng, 17, [3, 3, 2, 17], strict_alpha(4), 0.35)
        whole = _solve(problem)
        short.solver.begin_step()
        before = short.solver.counts["capped"]
        found = short.solve(problem)
        if short.solver.counts["capped"] == before:
            continue
        capped += 1
        if found.status is SolutionStatus.FAILED:  # not even the first level fits
            continue
        assert _violation(problem, found) <= 1e-6
        rows = slice(0, 3)
        miss = [
            np.linalg.norm(problem.jacobian[rows] @ one.acceleration - problem.target[rows])
            for one in (found, whole)
        ]
        assert miss[0] <= miss[1] + 1e-6 * np.linalg.norm(problem.target[rows])
    assert capped > 10


def test_what_the_first_level_relaxes_lower_levels_do_not_relax_further() -> None:
    """Boxes that the torques cannot reach: the slack is that of the first level alone. Seed 10."""
    rng = np.random.default_rng(10)
    seen = 0
    for _ in range(30):
        problem = random_problem(rng, 7, [3, 2, 7], strict_alpha(3), 0.3)
        lower = 30.0 * np.abs(rng.normal(size=7))
        problem = replace(problem, acceleration=Bounds(lower, lower + 1.0))
        whole = _solve(problem)
        if whole.status is not SolutionStatus.RELAXED:
            continue
        seen += 1
        first = _solve(_with(problem, matrix_from_hierarchy(TASKS, "a").alpha))
        assert whole.acceleration_slack is not None
        assert first.acceleration_slack is not None
        assert np.abs(whole.acceleration_slack - first.acceleration_slack).max() < 1e-5
    assert seen > 10


def test_no_candidate_takes_the_pivots_of_another() -> None:
    """Two orders that are answered alone within half of a step's pivots: so is their blend.

    60 problems of 17 joints, caps of 30 to 90 pivots. Seed 9.
    """
    rng = np.random.default_rng(9)
    forward = strict_alpha(4)
    backward = forward[::-1, ::-1].copy()
    mixture = Priorities.mixed((Candidate(forward, 0.9), Candidate(backward, 0.1)))
    judged = 0
    for _ in range(60):
        problem = random_problem(rng, 17, [3, 3, 2, 17], forward, 0.35)
        for cap in (30, 60, 90):
            alone = []
            for alpha in (forward, backward):
                found, _ = _capped(problem, Priorities.of(alpha), cap // 2)
                alone.append(found)
            if any(answer.status is SolutionStatus.FAILED for answer in alone):
                continue
            judged += 1
            both, spent = _capped(problem, mixture, cap)
            assert both.status is not SolutionStatus.FAILED
            assert spent <= cap
    assert judged > 60


def _capped(problem: ControlProblem, priorities: Priorities, cap: int) -> tuple[Solution, int]:
    solver = make_solver("daqp", SolverSettings(max_step_pivots=cap))
    formulation = make_formulation("cascade", FormulationSettings(), solver)
    solver.begin_step()
    solution = formulation.solve(replace(problem, priorities=priorities))
    solver.end_step()
    return solution, solver.step_pivots

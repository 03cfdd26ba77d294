"""The independent hard cascade against itself and brute force, and `hqp` against it."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from reference.feasibility import margin
from reference.hard_cascade import Infeasible, hard_cascade, kept_damping
from reference.hard_problems import BOUNDS, TASKS, hard_problems
from reference.plain import Level, Plain, violations
from reference.problems import (
    CONTACT_SINGULAR_VALUES,
    MASS_CONDITION,
    SINGULAR_VALUES,
    well_scaled,
    without_boxes,
)
from scipy.linalg import null_space

from benchmarks.problems.plain_problems import control_problem
from ghc_controller.formulations import FormulationSettings, SolutionStatus, make_formulation
from ghc_controller.types import Array

W = 1e-2


def _singular_values(rows: Array) -> Array:
    return np.asarray(np.linalg.svd(rows, compute_uv=False), dtype=np.float64)


def _within(values: Array, limits: tuple[float, float]) -> bool:
    return bool(values[-1] >= limits[0] - 1e-9 and values[0] <= limits[1] + 1e-9)


def test_the_conditioning_of_the_problems_is_as_stated() -> None:
    """Each task, and each stack of levels up to its rank, seed 5."""
    for problem in well_scaled(60):
        assert np.linalg.cond(problem.mass) <= MASS_CONDITION
        null = np.eye(len(problem.bias))
        if problem.contacts is not None:
            rows = problem.contacts.jacobian
            assert _within(_singular_values(rows), CONTACT_SINGULAR_VALUES)
            null = null_space(rows)
        stack = np.zeros((0, null.shape[1]))
        for level in problem.levels:
            local = level.jacobian @ null
            sigma = _singular_values(local)
            assert _within(sigma[sigma > 1e-9], SINGULAR_VALUES)
            rest = _singular_values(local @ null_space(stack))
            assert np.all((rest < 1e-9) | (rest > SINGULAR_VALUES[0] - 1e-9))
            stack = np.vstack([stack, local])


def test_the_reference_meets_bounds_and_kkt_conditions() -> None:
    """Also: a bound is active at level 1 or 2 in at least half, seen with and without bounds."""
    count = 60
    active = 0
    for problem in well_scaled(count):
        answer = hard_cascade(problem, W)
        assert answer.kkt < 1e-10
        assert answer.violation < 1e-10
        free = hard_cascade(without_boxes(problem), W)
        moved = [
            np.abs(a - b).max() > 1e-7
            for a, b in zip(answer.answers[:2], free.answers[:2], strict=True)
        ]
        assert any(moved) <= any(answer.active[:2])
        active += any(moved)
    assert active >= count / 2


def _brute_force(problem: Plain) -> list[Array]:
    """x after each level of a fixed base: the best of all candidate active sets."""
    n = len(problem.bias)
    rows = np.vstack([np.eye(n), -np.eye(n), problem.mass, -problem.mass])
    upper = np.concatenate(
        [
            problem.upper,
            -problem.lower,
            problem.torque_upper - problem.bias,
            problem.bias - problem.torque_lower,
        ]
    )
    x, null, answers = np.zeros(n), np.eye(n), []
    for level in problem.levels:
        d = null.shape[1]
        A = np.vstack([level.jacobian @ null, np.sqrt(W) * np.eye(d)])
        c = np.append(level.target - level.jacobian @ x, np.zeros(d))
        best: tuple[float, Array] = (np.inf, np.zeros(d))
        for chosen in (s for size in range(d + 1) for s in combinations(range(4 * n), size)):
            some = rows[list(chosen)] @ null
            gap = (upper - rows @ x)[list(chosen)]
            u = np.asarray(np.linalg.lstsq(some, gap, rcond=1e-10)[0], dtype=np.float64)
            if some.shape[0] < d:
                Z = null_space(some) if len(some) else np.eye(d)
                u = u + Z @ np.linalg.lstsq(A @ Z, c - A @ u, rcond=None)[0]
            if np.all(rows @ (x + null @ u) <= upper + 1e-9):
                best = min(best, (float(np.sum((A @ u - c) ** 2)), u), key=lambda pair: pair[0])
        x = x + null @ best[1]
        answers.append(x)
        null = null @ null_space(level.jacobian @ null, rcond=1e-10)
        if null.shape[1] == 0:
            break
    return answers


def test_the_reference_against_all_active_sets() -> None:
    """Tiny problems: 2 and 3 joints, two levels, tight boxes, seed 0."""
    rng = np.random.default_rng(0)
    held_back = 0
    for index in range(40):
        n = 2 + index % 2
        root = rng.normal(size=(n, n))
        mass, bias, half = root @ root.T + 0.3 * np.eye(n), rng.normal(size=n), rng.uniform(0.1, 1)
        levels = tuple(Level(rng.normal(size=(1, n)), 2 * rng.normal(size=1)) for _ in range(2))
        width = rng.uniform(0.1, 1.0, size=n)
        problem = Plain(levels, mass, bias, -width, width, bias - half, bias + half)
        answer = hard_cascade(problem, W)
        for mine, brute in zip(answer.answers, _brute_force(problem), strict=False):
            assert np.abs(mine - brute).max() < 1e-8
        held_back += any(answer.active)
    assert held_back >= 20


def test_no_feasible_point_leaves_a_lower_cost_in_contact() -> None:
    """Variational inequality of a convex optimum, for the first and for the only level.

    gradient . (z - z*) >= 0 for every feasible z = (x, f); as feasible points serve the optima of
    other targets, moved into the same null space.
    """
    rng = np.random.default_rng(1)
    problems = [p for p in well_scaled(36) if p.contacts is not None]
    assert len(problems) == 18
    for problem in problems:
        first, contacts = problem.levels[0], problem.contacts
        assert contacts is not None
        alone = problem._replace(levels=(first,))
        answer = hard_cascade(alone, W)  # the last level: forces cost
        upper = hard_cascade(problem, W).answers[0]  # forces cost nothing
        inverse = np.linalg.inv(contacts.factor @ contacts.factor.T)
        least = np.linalg.pinv(contacts.jacobian) @ contacts.drift

        def slope(x: Array, level: Level = first, least: Array = least) -> Array:
            return level.jacobian.T @ (level.jacobian @ x - level.target) + W * (x - least)

        for _ in range(5):
            target = first.target + 3.0 * rng.normal(size=len(first.target))
            other = hard_cascade(alone._replace(levels=(Level(first.jacobian, target),)), W)
            push = inverse @ (answer.force - contacts.center)
            both = slope(answer.x) @ (other.x - answer.x) + push @ (other.force - answer.force)
            assert both > -1e-8
            assert slope(upper) @ (other.x - upper) > -1e-8


def test_damping_pulls_to_the_braking_acceleration() -> None:
    """One level without bounds: x = y_0 + J^T (J J^T + w I)^-1 (b - J y_0), y_0 = -kd v."""
    rng = np.random.default_rng(2)
    problem = without_boxes(next(well_scaled(1)))
    J, b = problem.levels[0]
    velocity = rng.normal(size=len(problem.bias))
    start = -20.0 * velocity
    expected = start + J.T @ np.linalg.solve(J @ J.T + W * np.eye(len(b)), b - J @ start)
    answer = hard_cascade(problem._replace(levels=problem.levels[:1]), W, 20.0, velocity)
    assert np.abs(answer.x - expected).max() < 1e-10


def test_infeasible_bounds_are_seen() -> None:
    for problem in well_scaled(12):
        assert margin(problem) > 1e-3
        lower = problem.lower.copy()
        lower[0], upper = 1.0, np.where(np.arange(len(lower)) == 0, 0.5, problem.upper)
        impossible = problem._replace(lower=lower, upper=upper)
        assert margin(impossible) < -0.2
        with pytest.raises(Infeasible):
            hard_cascade(impossible, W)


@pytest.mark.parametrize("name", ["cascade", "hqp"])
def test_levels_1_and_2_are_those_of_the_reference(name: str) -> None:
    """30 problems, a bound active at level 1 or 2 in 26 of them; each under its own damping."""
    settings = FormulationSettings(regularization=W)
    formulation = make_formulation(name, settings)
    rule = kept_damping(W) if name == "cascade" else W
    for problem in well_scaled(30):
        formulation.solver.begin_step()
        answer = hard_cascade(problem, rule)
        solution = formulation.solve(control_problem(problem))
        assert solution.status is SolutionStatus.SOLVED
        assert max(violations(problem, solution.acceleration, solution.force)) <= 1e-6
        for level, miss in zip(problem.levels[:2], answer.residuals, strict=False):
            excess = np.linalg.norm(level.jacobian @ solution.acceleration - level.target) - miss
            assert excess <= 1e-6 * np.linalg.norm(level.target)
            assert excess > -1e-5  # bounds are widened by 2e-8 from level to level


def test_hard_problems_are_repeatable_and_of_every_kind() -> None:
    first, again = list(hard_problems(200)), list(hard_problems(200))
    words = {word for name, _ in first for word in name.split()}
    assert words == {*TASKS, *BOUNDS, "contacts", "scaled_mass"}
    for (name, a), (other, b) in zip(first, again, strict=True):
        assert name == other
        for mine, yours in zip(a.levels, b.levels, strict=True):
            assert np.array_equal(mine.jacobian, yours.jacobian)

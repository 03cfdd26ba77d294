"""Problems at the edge: tasks without rows, no task, no motion left, numbers that are none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.contacts.contact_set import ContactSet
from ghc_controller.contacts.settling import solve_settled
from ghc_controller.formulations import (
    FORMULATIONS,
    ContactRows,
    ControlProblem,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Bounds

NAMES = list(FORMULATIONS)


def _fixed(seed: int = 0) -> ControlProblem:
    return random_problem(np.random.default_rng(seed), 6, [3, 6], strict_alpha(2))


def _held(problem: ControlProblem, forces: bool) -> ControlProblem:
    """The six joints of a fixed base, welded at the hand: no motion is left."""
    jacobian = np.random.default_rng(5).normal(size=(6, 6))
    c = 6 if forces else 0
    rows = ContactRows(
        jacobian,
        np.zeros(6),
        jacobian[:c],
        np.zeros((0, c)),
        np.zeros(0),
        np.zeros(0),
        np.zeros(c),
        np.eye(c),
        (),
    )
    return replace(problem, contacts=rows)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("contacts", [0, 4])
def test_a_task_without_rows_changes_nothing(name: str, contacts: int) -> None:
    problem = random_problem(
        np.random.default_rng(1), 20, [3, 17], strict_alpha(2), None, contacts
    )
    with_empty = replace(
        problem,
        starts=np.array([0, 3, 3, 20], dtype=np.int64),
        priorities=Priorities.of(strict_alpha(3)),
    )
    formulation = make_formulation(name)
    assert formulation.solve(with_empty).status is SolutionStatus.SOLVED
    if name in ("cascade", "hqp"):  # weights of the others count the tasks between
        found, known = formulation.solve(with_empty), formulation.solve(problem)
        assert np.allclose(found.torque, known.torque, rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("contacts", [0, 4])
@pytest.mark.parametrize("share", [0.6, 1.0])
def test_without_an_active_task_there_is_an_answer(name: str, contacts: int, share: float) -> None:
    """Three tasks that are mostly or wholly removed: reached by pre-empted removals."""
    problem = random_problem(
        np.random.default_rng(2), 20, [3, 3, 14], strict_alpha(3), None, contacts
    )
    removed = replace(problem, priorities=Priorities.of(share * np.eye(3)))
    solution = make_formulation(name).solve(removed)
    assert solution.status is SolutionStatus.SOLVED
    assert np.isfinite(solution.torque).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("forces", [True, False])
def test_no_motion_is_left(name: str, forces: bool) -> None:
    held = _held(_fixed(), forces)
    assert held.contacts is not None
    solution = make_formulation(name).solve(held)
    assert solution.status is SolutionStatus.SOLVED
    assert np.abs(held.contacts.jacobian @ solution.acceleration).max() < 1e-9
    low = held.bias - 1.0
    tight = Bounds(low, low + 0.5)
    impossible = replace(_held(_fixed(), False), torque=tight, torque_limit=tight)
    refused = make_formulation(name).solve(impossible)
    assert refused.status is SolutionStatus.FAILED
    assert refused.reason


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("part", ["jacobian", "mass_matrix", "bias", "contact jacobian"])
def test_what_is_not_finite_is_named_and_not_solved(name: str, part: str) -> None:
    problem = random_problem(np.random.default_rng(3), 20, [3, 17], strict_alpha(2), None, 4)
    if part == "contact jacobian":
        assert problem.contacts is not None
        jacobian = problem.contacts.jacobian.copy()
        jacobian[0, 0] = np.nan
        spoiled = replace(problem, contacts=problem.contacts._replace(jacobian=jacobian))
    else:
        values = getattr(problem, part).copy()
        values.flat[0] = np.inf
        spoiled = replace(problem, **{part: values})
    contacts = ContactSet((), 0.0)
    solution, _ = solve_settled(make_formulation(name), spoiled, contacts, (), lambda: None)
    assert solution.status is SolutionStatus.FAILED
    assert solution.reason == f"{part} of the control problem is not finite"

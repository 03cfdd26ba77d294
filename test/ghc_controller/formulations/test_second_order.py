"""Second-order terms at torque level: what they minimize, and who rejects them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem

from ghc_controller.controller import Controller
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import FORMULATIONS, FormulationSettings, make_formulation
from ghc_controller.formulations.second_order import level_term, positive_part
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.reduction import reduce_contacts
from ghc_controller.problem.second_order_terms import SecondOrder
from ghc_controller.robot.library import load_robot
from ghc_controller.settings import Settings
from ghc_controller.tasks.python.joint_velocity import JointVelocityTask
from ghc_controller.types import Array, RobotState

N, W, KD, RATE = 7, 1e-2, 20.0, 12.0
TAKES_IT = ("cascade", "balanced", "hqp", "weighted")
SETTINGS = FormulationSettings(
    regularization=W, velocity_damping=KD, hqp_damps_velocity=True, second_order=True
)


def _positive(rng: np.random.Generator, count: int) -> Array:
    roots = rng.normal(size=(count, N, 2))  # rank 2
    return np.einsum("kia,kja->kij", roots, roots)


def _problem(
    rng: np.random.Generator, sizes: list[int], share: float | None = None
) -> ControlProblem:
    """Orthonormal rows per task, moving, with random terms of the tasks and error rows."""
    k, m = len(sizes), sum(sizes)
    problem = random_problem(rng, N, sizes, np.tril(np.ones((k, k)), -1), share)
    rows = rng.normal(size=(m, N, N))
    terms = SecondOrder(
        0.5 * (rows + rows.transpose(0, 2, 1)),
        _positive(rng, k),
        rng.normal(size=m),
        np.full(k, RATE),
    )
    return replace(problem, velocity=rng.normal(size=N), second_order=terms)


@pytest.mark.parametrize("name", TAKES_IT)
def test_a_single_level_minimizes_its_cost_with_the_term(name: str) -> None:
    """Seed 0: the gradient of |J x - b|^2 + (x + kd v)^T S (x + kd v) + w |x + kd/4 v|^2 is 0."""
    rng = np.random.default_rng(0)
    for _ in range(10):
        problem = _problem(rng, [3])
        assert problem.second_order is not None
        x = make_formulation(name, SETTINGS).solve(problem).acceleration
        J, b, v, S = problem.jacobian, problem.target, problem.velocity, problem.second_order.own
        gradient = J.T @ (J @ x - b) + S[0] @ (x + RATE * v) + W * (x + 0.25 * KD * v)
        assert np.abs(gradient).max() < 1e-8


@pytest.mark.parametrize("name", TAKES_IT)
@pytest.mark.parametrize("share", [None, 0.4])
def test_terms_that_are_zero_change_nothing(name: str, share: float | None) -> None:
    """Seed 1: also where torque bounds are active."""
    rng = np.random.default_rng(1)
    for _ in range(10):
        problem = _problem(rng, [2, 2, 3], share)
        assert problem.second_order is not None
        none = SecondOrder(*(0.0 * part for part in problem.second_order))
        formulation = make_formulation(name, SETTINGS)
        found = formulation.solve(replace(problem, second_order=none))
        expected = formulation.solve(replace(problem, second_order=None))
        assert found.status == expected.status
        scale = 1.0 + float(np.abs(expected.acceleration).max())
        np.testing.assert_allclose(found.acceleration, expected.acceleration, atol=2e-6 * scale)


@pytest.mark.parametrize("name", ["cascade", "hqp"])
def test_terms_of_a_lower_level_do_not_reach_the_one_above(name: str) -> None:
    """Seed 2: level 1 is solved with its own term, whatever the one of level 2 is."""
    rng = np.random.default_rng(2)
    for _ in range(10):
        problem = _problem(rng, [2, 3])
        terms = problem.second_order
        assert terms is not None
        flat = terms._replace(own=np.stack([np.zeros((N, N)), terms.own[1]]))
        flat = flat._replace(rows=0.0 * terms.rows)
        formulation = make_formulation(name, SETTINGS)
        with_term = formulation.solve(replace(problem, second_order=flat)).acceleration
        without = formulation.solve(replace(problem, second_order=None)).acceleration
        first = problem.jacobian[:2]
        np.testing.assert_allclose(first @ with_term, first @ without, atol=1e-6)
        assert np.abs(with_term - without).max() > 1e-3


def test_the_term_of_a_level_has_the_multipliers_of_the_rows_above() -> None:
    """Seed 3: where J_l^T e_l = A^T lambda with independent rows A, lambda enters."""
    rng = np.random.default_rng(3)
    problem = _problem(rng, [3, 1])
    terms = problem.second_order
    assert terms is not None
    A, known = problem.jacobian[:3], np.array([0.5, -1.0, 2.0])
    problem.jacobian[3] = known @ A
    terms.error[3] = 1.0
    above = np.array([1.0, 1.0, 1.0, 0.0])
    found = level_term(reduce_contacts(problem), [1], above, np.eye(N))
    expected = positive_part(terms.own[1] + np.tensordot(known, terms.rows[:3], 1))
    np.testing.assert_allclose(found.matrix, expected, atol=1e-2)
    np.testing.assert_allclose(found.pull, RATE * found.matrix @ problem.velocity)


@pytest.mark.parametrize("name", ["ghc", "ghc_full"])
def test_ghc_rejects_the_term_and_says_why(name: str) -> None:
    with pytest.raises(InvalidValue, match="identities"):
        make_formulation(name, SETTINGS)


@pytest.mark.parametrize("name", TAKES_IT)
def test_a_controller_computes_the_terms_of_its_tasks(name: str) -> None:
    controller = Controller.for_robot(
        "kuka_lwr", Settings(formulation=name, optimization=SETTINGS)
    )
    model = controller.model
    q = np.array([0.1, 0.4, -0.2, 1.0, 0.3, -0.7, 0.0])
    state = RobotState(0.0, q, np.zeros(N))
    controller.observe(state)
    assert controller.step(state).status.name == "SOLVED"
    terms = controller.problem().second_order
    assert terms is not None
    row = 0
    for task in controller.stack.tasks:
        for weights in np.eye(task.size):
            np.testing.assert_array_equal(terms.rows[row], task.curvature(model, weights))
            row += 1
    assert row == len(terms.error)


@pytest.mark.parametrize("name", sorted(FORMULATIONS.usable()))
def test_who_does_nothing_with_the_term_rejects_it(name: str) -> None:
    """Seed 2: the others answer otherwise with it."""
    problem = _problem(np.random.default_rng(2), [3])
    try:
        with_term = make_formulation(name, SETTINGS)
    except InvalidValue as error:
        assert "take cascade, balanced, hqp or weighted" in str(error)
        return
    linear = make_formulation(name, replace(SETTINGS, second_order=False))
    answer, other = (
        with_term.solve(problem).acceleration,
        linear.solve(replace(problem, second_order=None)).acceleration,
    )
    assert np.abs(answer - other).max() > 1e-3


def test_a_task_without_a_term_is_rejected_before_the_first_step() -> None:
    robot = load_robot("kuka_lwr")
    task = JointVelocityTask("still", robot.model, 2.0)
    hierarchy = f"{robot.hierarchy} > still"
    robot = replace(robot, tasks=(*robot.tasks, task), hierarchy=hierarchy)
    with pytest.raises(InvalidValue, match="second_order: task 'still' offers no"):
        Controller(robot, Settings.of(second_order=True))
    Controller(robot, Settings())

"""Baselines of Jeong and Chang (2009): operational space, unifying framework; what is rejected."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha
from strict_problems import (
    CASES,
    difference,
    null_basis,
    random_inertia,
    random_levels,
    strict_problem,
)

from ghc_controller.controller import Controller
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import (
    DampedLevels,
    FormulationSettings,
    Metric,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.formulations.baselines.operational_space import operational_space
from ghc_controller.formulations.baselines.strict_law import Level, order_in_force
from ghc_controller.formulations.baselines.unifying import unifying
from ghc_controller.hierarchy import Priorities, PriorityMatrix, Transition
from ghc_controller.hierarchy.priorities import Candidate
from ghc_controller.settings import Settings
from ghc_controller.types import Array

TOLERANCE = 1e-8
SEED = 8
LAWS = ("task_priority", "resolved_acceleration", "operational_space", "unifying")
NO_ORDERS = {
    "between": np.array([[0, 0.3, 0], [0, 0, 0], [1, 1, 0]]),
    "cycle": np.array([[0, 1.0, 0], [0, 0, 1], [1, 0, 0]]),
    "removed in part": np.array([[0.4, 0, 0], [1, 0, 0], [1, 1, 0]]),
}


def _accelerations(name: str, order: list[Level], mass: Array, **settings: object) -> Array:
    formulation = make_formulation(name, FormulationSettings(**settings))
    return formulation.solve(strict_problem(order, mass, np.zeros(len(mass)))).acceleration


@pytest.mark.parametrize("case", CASES)
def test_operational_space_is_18_in_the_metric_of_inertia(
    case: tuple[int, list[int], bool],
) -> None:
    """To 1e-7, conflicts included: 10 problems."""
    rng = np.random.default_rng(SEED)
    for _ in range(10):
        order, mass = random_levels(rng, *case), random_inertia(rng, case[0])
        expected = _accelerations(
            "task_priority", order, mass, metric=Metric.INERTIA, damped_levels=DampedLevels.NONE
        )
        found = operational_space(order, mass, [0.0] * len(order), TOLERANCE)
        assert difference(found, expected) < 1e-7


def test_39_is_a_pseudo_inverse_of_torque() -> None:
    """(J M^-1)^+ = M J^{M^2 +}, to 1e-10: (40) of one level."""
    rng = np.random.default_rng(SEED)
    mass = random_inertia(rng, 9)
    (level,) = random_levels(rng, 9, [3], False)
    expected = np.linalg.pinv(level.jacobian @ np.linalg.inv(mass)) @ level.target
    found = mass @ unifying([level], mass @ mass, [0.0], TOLERANCE)
    assert difference(found, expected) < 1e-10


def _torques_of_37(order: list[Level], mass: Array, bias: Array, inner: Array) -> Array:
    """(37) with `inner` in the place of C + G within its brackets."""
    inverse = np.linalg.inv(mass)
    later = np.zeros(len(mass))
    for jacobian, target in reversed(order):
        rows = jacobian @ inverse
        later = later + np.linalg.pinv(rows, rcond=1e-12) @ (target - rows @ (later - inner))
    return later + bias


def test_37_as_printed_counts_gravity_twice_and_40_does_not() -> None:
    """Printed: level 1 is missed by J_1 M^-1 h. (40) is the reading with C + G outside alone."""
    rng = np.random.default_rng(SEED)
    mass, bias = random_inertia(rng, 9), rng.normal(size=9)
    order = random_levels(rng, 9, [3, 2, 2], False)
    first, inverse = order[0], np.linalg.inv(mass)
    printed = inverse @ (_torques_of_37(order, mass, bias, bias) - bias)
    outside = inverse @ (_torques_of_37(order, mass, bias, np.zeros(9)) - bias)
    missed = first.jacobian @ printed - first.target
    assert difference(missed, first.jacobian @ inverse @ bias) < 1e-9
    assert difference(outside, unifying(order, mass @ mass, [0.0] * 3, TOLERANCE)) < 1e-9


def test_unifying_meets_level_1_only_and_level_3_disturbs_level_2() -> None:
    """The algorithmic error (34), absent where tasks are orthogonal in the metric."""
    rng = np.random.default_rng(SEED)
    mass, order = random_inertia(rng, 12), random_levels(rng, 12, [2, 3, 2], False)
    square = mass @ mass
    x = unifying(order, square, [0.0] * 3, TOLERANCE)
    moved = [*order[:2], Level(order[2].jacobian, order[2].target + 1.0)]
    change = unifying(moved, square, [0.0] * 3, TOLERANCE) - x
    (J1, b1), (J2, b2), _ = order
    assert np.abs(J1 @ x - b1).max() < 1e-9
    assert np.abs(J1 @ change).max() < 1e-9
    assert np.abs(J2 @ x - b2).max() > 1e-3
    assert np.abs(J2 @ change).max() > 1e-3
    inverse = np.linalg.inv(square)
    J2 = J2 - (J2 @ inverse @ J1.T) @ np.linalg.solve(J1 @ inverse @ J1.T, J1)
    x = unifying([order[0], Level(J2, b2)], square, [0.0] * 2, TOLERANCE)
    assert np.abs(J2 @ x - b2).max() < 1e-9


@pytest.mark.parametrize("name", LAWS)
def test_bounds_hold_and_bring_the_nearest_answer(name: str) -> None:
    """40 problems whose wanted torques exceed their box: SOLVED, within it, some by a QP."""
    rng = np.random.default_rng(SEED)
    formulation = make_formulation(name)
    bounded = 0
    for _ in range(40):
        problem = random_problem(rng, 9, [3, 2, 3], strict_alpha(3), torque_share=0.5)
        solution = formulation.solve(problem)
        assert solution.status is SolutionStatus.SOLVED
        assert (solution.torque >= problem.torque.lower - 1e-6).all()
        assert (solution.torque <= problem.torque.upper + 1e-6).all()
        bounded += solution.qp_solved
    assert bounded > 0


@pytest.mark.parametrize("name", LAWS)
def test_what_is_damped_brakes_towards_minus_kd_v(name: str) -> None:
    """Motions that no task claims get x = -kd v: the null space of all rows, to 1e-9."""
    rng = np.random.default_rng(SEED)
    order = random_levels(rng, 9, [3, 2], False)
    problem = strict_problem(order, np.eye(9), np.zeros(9))
    problem = replace(problem, velocity=rng.normal(size=9))
    x = make_formulation(name).solve(problem).acceleration
    null = null_basis(problem.jacobian)
    assert difference(null.T @ x, -20.0 * null.T @ problem.velocity) < 1e-9


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("kind", NO_ORDERS)
def test_a_matrix_that_is_no_order_is_rejected_with_a_reason(name: str, kind: str) -> None:
    controller = Controller.for_robot("kuka_lwr", Settings(formulation=name))
    tasks = controller.robot.task_names
    target = PriorityMatrix(tasks, NO_ORDERS[kind])
    with pytest.raises(InvalidValue, match=f"'{name}' knows orders only"):
        controller.add_transition(Transition(target, 1.0, 1.0), 0.0)
    ties = PriorityMatrix(tasks, np.array([[0, 0, 0], [0, 0, 0], [1.0, 1, 0]]))
    assert controller.add_transition(Transition(ties, 1.0, 1.0), 0.0)


def test_a_ramp_switches_where_the_new_order_has_the_larger_share() -> None:
    """Never a matrix between orders, also among three of them, whose majority is a cycle."""
    orders = [np.zeros((3, 3)) for _ in range(3)]
    for order, chain in zip(orders, ((0, 1, 2), (1, 2, 0), (2, 0, 1)), strict=True):
        for above in range(3):
            for below in range(above + 1, 3):
                order[chain[below], chain[above]] = 1.0
    for shares, expected in (((0.6, 0.4, 0.0), 0), ((0.5, 0.5, 0.0), 1), ((0.3, 0.3, 0.4), 2)):
        mixed = Priorities.mixed(map(Candidate, orders, shares))
        np.testing.assert_array_equal(order_in_force(mixed), orders[expected])

"""Formulation balanced: spread of its metric, singularities of its system, its own layers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.core.native import priority_weights
from ghc_controller.errors import GhcError
from ghc_controller.formulations import FormulationSettings, SolutionStatus, make_formulation
from ghc_controller.hierarchy import Priorities, ProjectorSettings
from ghc_controller.types import Array

CYCLE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # 1 > 2 > 3 > 1
SPREAD = 1e6


@pytest.mark.parametrize("k", [1, 2, 3, 5, 10])
def test_no_weight_exceeds_the_spread(k: int) -> None:
    """Strict orders of 1 to 10 tasks, ratios up to 1e6; the last level keeps the weight 1."""
    for ratio in (10.0, 1e3, 1e6):
        weights = priority_weights(strict_alpha(k), ratio, SPREAD)
        assert weights.max() <= SPREAD * (1.0 + 1e-9)
        assert weights[-1] == 1.0
        assert (np.diff(weights) < 0.0).all()


def test_removed_tasks_do_not_flatten_the_weights() -> None:
    """Three tasks of ten that are in have the weights of three tasks alone."""
    alpha = np.ones((10, 10))
    alpha[:3] = 0.0
    alpha[:3, :3] = strict_alpha(3)
    weights = priority_weights(alpha, 1e3, SPREAD)
    assert np.allclose(weights[:3], [1e6, 1e3, 1.0])
    assert (weights[3:] == 0.0).all()


def test_weights_are_continuous_while_a_task_comes_in() -> None:
    """Steps of an insertion into five tasks shrink with those of alpha."""
    start, goal = np.ones((6, 6)), strict_alpha(6)
    start[:5] = 0.0
    start[:5, :5] = strict_alpha(5)

    def logarithm(s: float) -> Array:
        return np.log(priority_weights(start + s * (goal - start), 1e3, SPREAD)[:5])

    for s in (0.0, 0.3, 0.7, 1.0 - 1e-4):
        steps = [np.abs(logarithm(s + h) - logarithm(s)).max() for h in (1e-4, 1e-6)]
        assert steps[1] < 0.02 * steps[0] + 1e-12


def test_ten_levels_are_solved_where_bounds_are_active() -> None:
    """28 joints, no task that fills them, torque bounds active: none of 40 fails."""
    rng = np.random.default_rng(41)
    formulation = make_formulation("balanced")
    for _ in range(40):
        problem = random_problem(rng, 28, [3, 2, 3, 3], strict_alpha(4), torque_share=0.3)
        solution = formulation.solve(problem)
        assert solution.qp_solved
        assert solution.status is SolutionStatus.SOLVED


def _ramp(start: Array, goal: Array, count: int) -> list[Array]:
    return [start + s * (goal - start) for s in np.linspace(0.0, 1.0, count)]


@pytest.mark.parametrize("seed", [17, 37, 131])
def test_a_ramp_through_a_singularity_is_refused(seed: int) -> None:
    """Three tasks on five joints, from 1 > 2 > 3 to a circle: its torques jump, and it is seen."""
    problem = random_problem(np.random.default_rng(seed), 5, [3, 3, 3], strict_alpha(3))
    formulation = make_formulation("balanced")
    torques = [
        formulation.solve(replace(problem, priorities=Priorities.of(alpha))).torque
        for alpha in _ramp(strict_alpha(3), CYCLE, 1001)
    ]
    steps = np.abs(np.diff(torques, axis=0)).max(axis=1)
    assert steps.max() > 1e3 * np.median(steps)
    solvability = formulation.solvability(problem.jacobian, problem.starts)
    with pytest.raises(GhcError, match=r"would be singular.*a, b, c"):
        solvability.check(strict_alpha(3), CYCLE, ("a", "b", "c"))
    projectors = make_formulation("ghc").solvability(problem.jacobian, problem.starts)
    assert projectors.check(strict_alpha(3), CYCLE, ("a", "b", "c")) > projectors.least


def test_ramps_between_orders_of_independent_tasks_are_accepted() -> None:
    """100 pairs of strict orders of 2 to 6 random tasks."""
    rng = np.random.default_rng(43)
    formulation = make_formulation("balanced")
    for _ in range(100):
        k = int(rng.integers(2, 7))
        problem = random_problem(rng, 7, [2] * k, strict_alpha(k))
        shuffled = rng.permutation(k)
        start = strict_alpha(k)[np.ix_(shuffled, shuffled)]
        solvability = formulation.solvability(problem.jacobian, problem.starts)
        assert solvability.check(start, strict_alpha(k), tuple("abcdef")) >= solvability.least


def test_ramps_between_orders_are_refused_only_where_torques_jump() -> None:
    """Nearly dependent tasks: those rejected have a step that stands out, the others have none."""
    rng = np.random.default_rng(45)
    formulation = make_formulation("balanced")
    refused = 0
    for _ in range(40):
        problem = random_problem(rng, 7, [2] * 4, strict_alpha(4))
        jacobian = problem.jacobian.copy()
        jacobian[2:4] = jacobian[:2] + 0.1 * jacobian[2:4]
        shuffled = rng.permutation(4)
        start = strict_alpha(4)[np.ix_(shuffled, shuffled)]
        torques = np.array(
            [
                formulation.solve(
                    replace(problem, jacobian=jacobian, priorities=Priorities.of(alpha))
                ).torque
                for alpha in _ramp(start, strict_alpha(4), 201)
            ]
        )
        largest = np.abs(np.diff(torques, axis=0)).max()
        change = np.abs(torques[-1] - torques[0]).max()
        solvability = formulation.solvability(jacobian, problem.starts)
        try:
            solvability.check(start, strict_alpha(4), tuple("abcd"))
        except GhcError:
            refused += 1
            assert largest > 2.0 * change
        else:
            assert largest < 2.0 * change + 1e-9
    assert 0 < refused < 10


@pytest.mark.parametrize("name", ["balanced", "cascade"])
def test_without_a_task_all_joints_brake_and_nobody_may_ask_for_it(name: str) -> None:
    """x = -kd v; as the target of a transition it is rejected: somebody has to say where to go."""
    problem = random_problem(np.random.default_rng(44), 7, [3, 3], strict_alpha(2))
    removed = replace(problem, priorities=Priorities.of(np.ones((2, 2))), velocity=np.ones(7))
    formulation = make_formulation(name)
    solvability = formulation.solvability(problem.jacobian, problem.starts)
    with pytest.raises(GhcError, match=r"no task is left.*a, b"):
        solvability.check(strict_alpha(2), np.ones((2, 2)), ("a", "b"))
    wanted = -formulation.settings.velocity_damping * removed.velocity
    assert np.allclose(formulation.solve(removed).acceleration, wanted, rtol=0, atol=1e-9)


def test_layers_are_damped_unless_told_otherwise() -> None:
    """The default of balanced bridges a rank change; the other formulations stay exact."""
    open_, exact = (
        FormulationSettings(),
        FormulationSettings(projector=ProjectorSettings(1e-7, 0.0)),
    )
    assert make_formulation("balanced", open_).projector.layer_damping == 2.5e-6
    assert make_formulation("balanced", exact).projector.layer_damping == 0.0
    assert make_formulation("ghc", open_).projector.layer_damping == 0.0


def test_tasks_that_put_each_other_first_give_up_what_they_share() -> None:
    """Two equal tasks with alpha_12 = alpha_21 = 1 block each other; in any order both are met."""
    rng = np.random.default_rng(46)
    problem = random_problem(rng, 7, [2, 2, 7], strict_alpha(3))
    jacobian, target = problem.jacobian.copy(), problem.target.copy()
    jacobian[2:4], target[2:4] = jacobian[:2], target[:2]
    target[4:] = 0.0
    mutual = strict_alpha(3)
    mutual[0, 1] = 1.0
    missed = []
    for alpha in (strict_alpha(3), mutual):
        same = replace(problem, jacobian=jacobian, target=target, priorities=Priorities.of(alpha))
        x = make_formulation("balanced").solve(same).acceleration
        missed.append(np.linalg.norm(jacobian[:2] @ x - target[:2]) / np.linalg.norm(target[:2]))
    assert missed[0] < 0.01
    assert missed[1] > 0.99

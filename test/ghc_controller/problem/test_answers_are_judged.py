"""Whatever a solver says: SOLVED means that no row is violated in rad/s^2, Nm or N."""

from __future__ import annotations

import os

import numpy as np
import pytest
from hard_problems import hard_problem, violation

from ghc_controller.controller import Controller
from ghc_controller.core.native import cholesky, inverse_factor
from ghc_controller.formulations import (
    FormulationSettings,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.qp import VIOLATION_TOLERANCE, make_solver
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.report.report import StepStatus
from ghc_controller.settings import Settings
from ghc_controller.types import RobotState, TaskTarget

_PROBLEMS = int(os.environ.get("HARD_PROBLEMS", "120"))


@pytest.mark.parametrize("name", ["cascade", "balanced", "hqp", "ghc", "weighted"])
def test_hard_problems(name: str) -> None:
    """No exception, no violated row behind SOLVED, no step beyond its pivots; few give way.

    Seed 11. Torque limits and the equation of motion hold also where soft rows give way.
    """
    rng = np.random.default_rng(11)
    solver = make_solver("daqp")
    formulation = make_formulation(name, FormulationSettings(), solver)
    needless = 0
    for _ in range(_PROBLEMS):
        problem, stands = hard_problem(rng)
        solver.begin_step()
        solution = formulation.solve(problem)
        assert solver.pivots_left >= 0
        if solution.status is SolutionStatus.FAILED:
            assert solution.reason
            assert np.isnan(solution.torque).all()
        else:
            soft = solution.status is SolutionStatus.SOLVED
            found = violation(problem, solution.acceleration, solution.torque, soft)
            assert found <= VIOLATION_TOLERANCE
            assert solution.violation <= VIOLATION_TOLERANCE
        needless += stands and solution.status is not SolutionStatus.SOLVED
    assert needless <= _PROBLEMS // 100


@pytest.mark.parametrize("name", ["cascade", "balanced", "hqp"])
@pytest.mark.parametrize("distance", [1e6, 1e12, 1e150, 1e300])
def test_a_reference_out_of_this_world(name: str, distance: float) -> None:
    """The step ends within its pivots, and its torque is finite and within the limits."""
    controller = Controller.for_robot("kuka_lwr", Settings(formulation=name))
    q, v = np.full(7, 0.4), np.zeros(7)
    controller.observe(RobotState(0.0, q, v))
    task = controller.robot.tasks[0]
    target = TaskTarget(np.array([distance, 0.0, 0.0]), np.zeros(3), np.zeros(3))
    controller.add_reference(ReferenceTrajectory.static(task, target))
    result = controller.step(RobotState(0.0, q, v, torque=controller.model.dynamics.bias.copy()))
    assert np.all(np.abs(result.torque) <= controller.model.torque_limit)
    assert controller.formulation.solver.step_pivots <= 1000
    if result.status is StepStatus.FALLBACK:
        assert controller.report().fallback_reason == f"no answer: {result.solution.reason}"


def test_counts_of_the_solver_are_those_of_the_controller() -> None:
    """`second_solver`, `capped` and `not_finite` appear beside the other counters."""
    controller = Controller.for_robot("kuka_lwr")
    assert {"second_solver", "capped", "not_finite"} <= controller.counts.keys()
    controller.formulation.solver.counts["capped"] = 3
    controller.step(RobotState(0.0, np.full(7, 0.4), np.zeros(7)))
    assert controller.counts["capped"] == 3
    assert controller.report().counts["capped"] == 3


def test_factors_of_singular_matrices_stay_bounded() -> None:
    """Rank 3 of 20, entries of 1e13: the inverse factor is finite and the factor reproduces it."""
    rng = np.random.default_rng(4)
    for _ in range(50):
        rows = rng.normal(size=(3, 20)) * 10.0 ** rng.uniform(-2, 7, size=(3, 1))
        matrix = rows.T @ rows + 1e-4 * np.eye(20)
        lower = cholesky(matrix)
        assert np.abs(lower @ lower.T - matrix).max() <= 1e-12 * np.abs(matrix).max()
        assert np.abs(inverse_factor(matrix)).max() <= 1e8

"""Formulations against each other and against the optimality conditions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_problems import random_alpha, random_problem, strict_alpha

from ghc_controller.errors import GhcError
from ghc_controller.formulations import (
    FORMULATIONS,
    ControlProblem,
    Formulation,
    FormulationSettings,
    Solution,
    SolutionStatus,
    TorqueRegularization,
    make_formulation,
)
from ghc_controller.hierarchy import Priorities, ProjectorSettings, matrix_from_hierarchy
from ghc_controller.qp import QpProblem, QpStatus, SolverSettings, make_solver
from ghc_controller.types import Array, Bounds

EXACT = SolverSettings(tolerance=1e-12, max_iterations=500)


def _make(
    name: str, w: float = 1e-4, torque: str = "none", layer_damping: float = -1.0
) -> Formulation:
    settings = FormulationSettings(
        regularization=w,
        torque_regularization=TorqueRegularization(torque),
        projector=ProjectorSettings(layer_damping=layer_damping),
    )
    return make_formulation(name, settings, make_solver("daqp", EXACT))


def _miss(problem: ControlProblem, solution: Solution, task: int) -> float:
    rows = slice(problem.starts[task], problem.starts[task + 1])
    return float(
        np.linalg.norm(problem.jacobian[rows] @ solution.acceleration - problem.target[rows])
    )


def _length(problem: ControlProblem, task: int) -> float:
    return float(np.linalg.norm(problem.target[problem.starts[task] : problem.starts[task + 1]]))


def _difference(a: Solution, b: Solution) -> float:
    x = np.abs(a.acceleration - b.acceleration).max() / max(1.0, np.abs(b.acceleration).max())
    return float(max(x, np.abs(a.force - b.force).max(initial=0.0) / 100.0))


def _any_problem(rng: np.random.Generator, index: int) -> ControlProblem:
    contacts = 4 if index % 4 == 0 else 0
    n = int(rng.integers(20 if contacts else 7, 39))
    k = int(rng.integers(1, 9))
    sizes = [int(rng.integers(1, 4)) for _ in range(k)]
    share = None if contacts else [None, 0.5, 0.8][index % 3]
    problem = random_problem(rng, n, sizes, random_alpha(rng, k), share, contacts)
    return replace(problem, velocity=0.2 * np.random.default_rng(index).normal(size=n))


def test_condensed_equals_full() -> None:
    """ghc = ghc_full to 1e-8 at w = 1e-4: 200 problems, 7 to 38 DoF, 1 to 8 tasks, contacts."""
    rng = np.random.default_rng(11)
    condensed, full = _make("ghc"), _make("ghc_full")
    worst, bounded, relaxed = 0.0, 0, 0
    for index in range(200):
        problem = _any_problem(rng, index)
        problem.check()
        a, b = condensed.solve(problem), full.solve(problem)
        assert a.status is b.status
        assert a.status is not SolutionStatus.FAILED
        bounded += a.qp_solved
        relaxed += a.status is SolutionStatus.RELAXED
        worst = max(worst, _difference(a, b))
    assert worst < 1e-8
    assert bounded > 80  # the comparison covers active bounds
    assert relaxed < 100


@pytest.mark.parametrize("torque", ["bias", "zero"])
def test_condensed_equals_full_with_torque_weight(torque: str) -> None:
    """The weight on torque means the same in both forms."""
    rng = np.random.default_rng(12)
    for index in range(40):
        problem = _any_problem(rng, index)
        a = _make("ghc", torque=torque).solve(problem)
        b = _make("ghc_full", torque=torque).solve(problem)
        assert _difference(a, b) < 1e-7


def test_balanced_is_lexicographic_without_bounds() -> None:
    """balanced with exact layers = damped cascade at strict orders, to 1e-9."""
    rng = np.random.default_rng(13)
    for _ in range(100):
        n, k = int(rng.integers(7, 39)), int(rng.integers(1, 6))
        problem = random_problem(rng, n, [3] * k, strict_alpha(k))
        a = _make("balanced", 1e-2, layer_damping=0.0).solve(problem)
        b = _make("hqp", 1e-2).solve(problem)
        assert np.abs(a.acceleration - b.acceleration).max() < 1e-9


def test_balanced_protects_levels_at_active_bounds() -> None:
    """Excess over the cascade below 1e-3 of |b| at level 1 and 2, median of 200 problems."""
    rng = np.random.default_rng(14)
    excess: list[list[float]] = [[], []]
    for _ in range(200):
        problem = random_problem(rng, 7, [3, 2, 7], strict_alpha(3), torque_share=0.5)
        a, b = _make("balanced").solve(problem), _make("hqp").solve(problem)
        assert a.qp_solved
        for task in (0, 1):
            gap = _miss(problem, a, task) - _miss(problem, b, task)
            excess[task].append(gap / _length(problem, task))
    assert np.median(excess[0]) < 1e-3
    assert np.median(excess[1]) < 1e-3
    assert np.median(np.abs(excess[0])) < 1e-3  # neither is level 1 lost, nor the other way round


@pytest.mark.parametrize("name", FORMULATIONS)
def test_equation_of_motion_and_bounds_hold(name: str) -> None:
    """Whatever the formulation: inverse dynamics, torque box, friction rows, contacts."""
    rng = np.random.default_rng(15)
    for index in range(40):
        problem = _any_problem(rng, index)
        solution = _make(name, 1e-2).solve(problem)
        assert solution.status is not SolutionStatus.FAILED
        left = problem.mass_matrix @ solution.acceleration + problem.bias
        if problem.contacts is not None:
            left = left - problem.contacts.jacobian.T @ solution.force
            push = problem.contacts.force_matrix @ solution.force
            assert (push <= problem.contacts.force_upper + 1e-5).all()
            still = problem.contacts.jacobian @ solution.acceleration
            assert np.allclose(still, problem.contacts.drift_target, atol=1e-6)
        scale = max(1.0, np.abs(left).max())
        assert np.abs(left[: problem.unactuated]).max(initial=0.0) < 1e-5 * scale
        assert np.allclose(left[problem.unactuated :], solution.torque, atol=1e-7 * scale)
        assert (solution.torque <= problem.torque.upper + 1e-5).all()
        assert (solution.torque >= problem.torque.lower - 1e-5).all()


@pytest.mark.parametrize("name", ["ghc", "ghc_full", "balanced", "weighted"])
def test_torque_is_continuous_in_alpha(name: str) -> None:
    """On a fine ramp between two strict orders with an insertion no step stands out."""
    rng = np.random.default_rng(16)
    tasks = ("a", "b", "c")
    start = matrix_from_hierarchy(tasks, "c > b").alpha
    goal = matrix_from_hierarchy(tasks, "a > b > c").alpha
    problem = random_problem(rng, 7, [3, 2, 7], start, torque_share=0.8)
    formulation = _make(name, 1e-2)

    def torque(s: float) -> Array:
        return formulation.solve(
            replace(problem, priorities=Priorities.of(start + s * (goal - start)))
        ).torque

    for center in (1e-3, 0.25, 0.5, 0.75, 1.0 - 1e-3):
        steps = [np.abs(torque(center + h) - torque(center)).max() for h in (1e-4, 1e-5, 1e-6)]
        assert steps[1] < 0.2 * steps[0] + 1e-6
        assert steps[2] < 0.2 * steps[1] + 1e-6


def test_removed_task_leaves_no_trace() -> None:
    """With a task removed by its row the answer is that of the problem without it."""
    rng = np.random.default_rng(17)
    tasks = ("a", "b", "c")
    alpha = matrix_from_hierarchy(tasks, "a > c").alpha
    problem = random_problem(rng, 7, [3, 2, 7], alpha, torque_share=0.7)
    keep = np.r_[0:3, 5:12]
    without = replace(
        problem,
        jacobian=problem.jacobian[keep],
        target=problem.target[keep],
        starts=np.array([0, 3, 10]),
        priorities=Priorities.of(strict_alpha(2)),
    )
    for name in FORMULATIONS:
        a, b = _make(name).solve(problem), _make(name).solve(without)
        assert np.abs(a.acceleration - b.acceleration).max() < 1e-5


@pytest.mark.parametrize("name", FORMULATIONS)
def test_soft_rows_give_way_to_torque(name: str) -> None:
    """A velocity box that the torques cannot meet yields, by name and amount; torque holds."""
    rng = np.random.default_rng(18)
    problem = random_problem(rng, 7, [3, 7], strict_alpha(2), torque_share=0.2)
    need = np.full(7, 500.0)  # [rad/s^2] far beyond what the torque box allows
    problem = replace(problem, acceleration=Bounds(need, np.full(7, np.inf)))
    solution = _make(name, 1e-2).solve(problem)
    assert solution.status is SolutionStatus.RELAXED
    assert solution.acceleration_slack is not None
    assert solution.acceleration_slack.max() > 1.0
    assert not solution.rate_gave_way
    assert (solution.torque <= problem.torque.upper + 1e-6).all()
    assert (solution.torque >= problem.torque.lower - 1e-6).all()


def test_rate_rows_give_way_before_torque_limits() -> None:
    """An empty rate box yields to the torque limits, and says so."""
    rng = np.random.default_rng(19)
    problem = random_problem(rng, 7, [3, 7], strict_alpha(2), torque_share=0.5)
    beyond = problem.torque_limit.upper + 5.0
    problem = replace(problem, torque=Bounds(beyond + 1.0, beyond - 1.0))
    solution = _make("ghc").solve(problem)
    assert solution.rate_gave_way
    assert (solution.torque <= problem.torque_limit.upper + 1e-6).all()


def test_conflict_takes_bounded_effort() -> None:
    """ProxQP on rows that conflict ends at its iteration limit; DAQP sees it at once."""
    rows = np.vstack([np.eye(7), np.eye(7)])
    lower = np.concatenate([np.full(7, -1.0), np.full(7, 2.0)])
    problem = QpProblem(
        np.eye(7), np.zeros(7), np.zeros((0, 7)), np.zeros(0), rows, lower, lower + 2.0
    )
    settings = SolverSettings(max_iterations=50)
    slow = make_solver("proxqp", settings).solve(problem)
    assert not slow.found
    assert slow.iterations <= 50 * 10
    assert make_solver("daqp", settings).solve(problem).status is QpStatus.INFEASIBLE


def test_unknown_names_list_the_known() -> None:
    """A formulation or solver that does not exist."""
    with pytest.raises(GhcError, match="known: " + ", ".join(sorted(FORMULATIONS))):
        make_formulation("sot")
    with pytest.raises(GhcError, match="daqp, proxqp"):
        make_solver("osqp")


@pytest.mark.parametrize("name", FORMULATIONS)
def test_solvers_agree(name: str) -> None:
    """ProxQP and DAQP find the same torque where bounds are active."""
    rng = np.random.default_rng(20)
    for _ in range(10):
        problem = random_problem(rng, 7, [3, 7], strict_alpha(2), torque_share=0.8)
        settings = FormulationSettings(regularization=1e-2, metric_ratio=1e2)
        limits = SolverSettings(tolerance=1e-9, max_iterations=2000)
        torques = [
            make_formulation(name, settings, make_solver(solver, limits)).solve(problem).torque
            for solver in ("proxqp", "daqp")
        ]
        assert np.abs(torques[0] - torques[1]).max() < 1e-3

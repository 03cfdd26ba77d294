"""QP solvers: residuals rather than trust in a success flag."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from ghc_controller.core import native
from ghc_controller.errors import WrongSize
from ghc_controller.qp import (
    SOLVERS,
    QpProblem,
    QpResult,
    QpSolver,
    QpStatus,
    SolverSettings,
    make_solver,
    residuals,
)
from ghc_controller.qp.dual_solver import DualSolver
from ghc_controller.qp.fallback import Fallback
from ghc_controller.types import Array

SETTINGS = SolverSettings()


class _Wrong(QpSolver):
    """Ends every QP with one status, and with an answer that is none."""

    name = "wrong"

    def __init__(self, status: QpStatus) -> None:
        super().__init__(SETTINGS)
        self._status = status

    def run(self, problem: QpProblem, limit: int) -> QpResult:
        return QpResult(problem.g + 1.0, problem.b, problem.l * 0.0, self._status, limit // 10)


def _make(name: str, settings: SolverSettings = SETTINGS) -> QpSolver:
    """A solver that can be chosen, or the second one alone."""
    return DualSolver(settings) if name == "dual" else make_solver(name, settings)


def _random_qp(rng: np.random.Generator, n: int, equalities: int, rows: int) -> QpProblem:
    inside = 0.3 * rng.normal(size=n)
    matrix, normals = rng.normal(size=(equalities, n)), rng.normal(size=(rows, n))
    middle = normals @ inside
    return QpProblem(
        np.eye(n),
        rng.normal(size=n),
        matrix,
        matrix @ inside,
        normals,
        middle - 1.0,
        middle + 1.0,
    )


@pytest.mark.parametrize("part", ["b", "row"])
def test_a_number_that_is_none_ends_the_dual_method_as_failed(part: str) -> None:
    """No row blocks the step then, and there is none to be taken out."""
    matrix, right = np.array([[1.0, 0.5]]), np.array([0.3])
    (right if part == "b" else matrix).flat[0] = np.nan
    none, empty = np.zeros((0, 2)), np.zeros(0)
    end, pivots, *_ = native.solve_dual(
        np.eye(2), np.ones(2), matrix, right, none, empty, empty, 50
    )
    assert end == 3
    assert pivots <= 1


@pytest.mark.parametrize("solver", [*SOLVERS, "dual"])
@pytest.mark.parametrize("sizes", [(7, 0, 14), (20, 6, 40), (7, 0, 0)])
def test_kkt_residuals(solver: str, sizes: tuple[int, int, int]) -> None:
    """Primal and dual residual of every answer below 1e-8, also after a change of size."""
    rng = np.random.default_rng(0)
    instance = _make(solver)
    instance.solve(_random_qp(rng, 5, 1, 3))
    for _ in range(20):
        problem = _random_qp(rng, *sizes)
        problem.check()
        result = instance.solve(problem)
        assert result.found
        check = residuals(problem, result)
        assert check.primal < 1e-8
        assert check.dual < 1e-8
        assert check.complementarity < 1e-3


def test_residuals_see_a_wrong_answer() -> None:
    """A shifted answer with the flag of success is not believed."""
    problem = _random_qp(np.random.default_rng(1), 7, 2, 14)
    good = make_solver("daqp").solve(problem)
    bad = QpResult(good.x + 0.1, good.y, good.z, QpStatus.SOLVED, 1)
    assert residuals(problem, bad).primal > 1e-3
    assert residuals(problem, bad).dual > 1e-3


def test_recovers_after_a_conflict() -> None:
    """A problem without solution leaves no trace in the next one."""
    rng = np.random.default_rng(2)
    good = _random_qp(rng, 7, 0, 14)
    bad = QpProblem(good.H, good.g, good.A, good.b, good.C, good.l + 50.0, good.l + 40.0)
    for name in (*SOLVERS, "dual"):
        solver = _make(name)
        assert not solver.solve(bad).found
        assert residuals(good, solver.solve(good)).primal < 1e-8


def test_shapes_are_checked() -> None:
    """A matrix that does not fit is named with both shapes."""
    good = _random_qp(np.random.default_rng(3), 4, 0, 3)
    with pytest.raises(WrongSize, match=r"QP matrix C.*\(3, 3\) given, \(3, 4\) expected"):
        QpProblem(good.H, good.g, good.A, good.b, good.C[:, :3], good.l, good.u).check()


def test_the_second_solver_finds_the_least_distance() -> None:
    """300 whitened QPs as least-distance problems of Lawson and Hanson, solved by NNLS; seed 5.

    A third are infeasible: both see it. Points differ by at most 1e-8 of their size.
    """
    rng = np.random.default_rng(5)
    solver, conflicts = DualSolver(SETTINGS), 0
    for trial in range(300):
        n, r = int(rng.integers(3, 20)), int(rng.integers(1, 40))
        problem = _random_qp(rng, n, 0, r)
        shift = 3.0 * rng.normal(size=r) if trial % 3 == 0 else np.zeros(r)
        problem = problem._replace(g=np.zeros(n), l=problem.l + shift, u=problem.u + shift)
        expected = _least_distance(np.vstack([problem.C, -problem.C]), [problem.l, -problem.u])
        result = solver.solve(problem)
        if expected is None:
            conflicts += 1
            assert result.status is QpStatus.INFEASIBLE
        else:
            assert result.found
            assert np.abs(result.x - expected).max() <= 1e-8 * (1.0 + np.abs(expected).max())
    assert conflicts > 20


def _least_distance(rows: Array, sides: list[Array]) -> Array | None:
    """The x of min |x| subject to rows x >= bounds; None where there is none."""
    bounds = np.concatenate(sides)
    scale = max(float(bounds.max()), 1e-3)
    system = np.vstack([rows.T, bounds / scale])
    right = np.zeros(system.shape[0])
    right[-1] = 1.0
    weights, distance = nnls(system, right)
    if distance < 1e-7:
        return None
    residual = system @ weights - right
    return -scale * residual[:-1] / residual[-1]


def test_equalities_that_depend_on_each_other() -> None:
    """A repeated equality changes nothing; one that contradicts is infeasible. Seed 6."""
    rng = np.random.default_rng(6)
    solver = DualSolver(SETTINGS)
    for _ in range(50):
        problem = _random_qp(rng, 8, 3, 10)
        double = problem._replace(
            A=np.vstack([problem.A, 2.0 * problem.A[1]]),
            b=np.append(problem.b, 2.0 * problem.b[1]),
        )
        once, twice = solver.solve(problem), solver.solve(double)
        assert twice.found
        assert np.abs(once.x - twice.x).max() < 1e-9
        against = double._replace(b=np.append(problem.b, 2.0 * problem.b[1] + 1e-3))
        assert solver.solve(against).status is QpStatus.INFEASIBLE


@pytest.mark.parametrize("status", QpStatus)
def test_no_status_of_the_first_solver_stands_alone(status: QpStatus) -> None:
    """INFEASIBLE, a limit, a failure or a wrong answer: the second solver decides, and counts."""
    rng = np.random.default_rng(7)
    solver = Fallback(_Wrong(status), DualSolver(SETTINGS), SETTINGS)
    for count in range(1, 6):
        problem = _random_qp(rng, 7, 2, 14)
        result, check = solver.solve_checked(problem)
        assert result.found
        assert check.small
        assert solver.counts["second_solver"] == count
    conflict = problem._replace(l=problem.l + 50.0, u=problem.l + 40.0)
    assert solver.solve(conflict).status is QpStatus.INFEASIBLE


@pytest.mark.parametrize("name", [*SOLVERS, "dual"])
@pytest.mark.parametrize("field", QpProblem._fields)
def test_what_is_not_finite_is_named(name: str, field: str) -> None:
    """NaN in any part, or a bound that is infinite on the wrong side: FAILED before any pivot."""
    problem = _random_qp(np.random.default_rng(8), 5, 1, 4)
    wrong = {"l": np.inf, "u": -np.inf}.get(field, np.nan)
    for value in (np.nan, wrong):
        part = getattr(problem, field).copy()
        part.flat[-1] = value
        solver = _make(name)
        result = solver.solve(problem._replace(**{field: part}))
        assert result.status is QpStatus.FAILED
        assert result.reason == f"{field} of the QP is not finite"
        assert result.iterations == 0
        assert solver.counts["not_finite"] == 1
    open_side = problem._replace(l=np.full(4, -np.inf), u=np.full(4, np.inf))
    assert _make(name).solve(open_side).found


@pytest.mark.parametrize("name", [*SOLVERS, "dual"])
def test_pivots_are_capped(name: str) -> None:
    """A QP that needs more ends with ITERATION_LIMIT, at the same count each time. Seed 9."""
    problem = _random_qp(np.random.default_rng(9), 20, 0, 60)
    problem = problem._replace(g=100.0 * problem.g)
    few = SolverSettings(max_pivots=3, max_iterations=1)
    for _ in range(2):
        solver = _make(name, few)
        result = solver.solve(problem)
        assert result.status is QpStatus.ITERATION_LIMIT
        assert result.iterations <= solver.pivots_per_qp + 1
        assert solver.counts["capped"] == 1


@pytest.mark.parametrize("name", [*SOLVERS, "dual"])
def test_a_step_has_a_budget(name: str) -> None:
    """Once spent, a QP is not begun; the next step has all of it; same in each run. Seed 10."""
    problem = _random_qp(np.random.default_rng(10), 20, 0, 60)
    problem = problem._replace(g=100.0 * problem.g)
    runs = []
    for _ in range(2):
        solver = _make(name, SolverSettings(max_step_pivots=100))
        assert all(solver.solve(problem).found for _ in range(10))  # no step has begun yet
        pivots = []
        for _ in range(2):
            solver.begin_step()
            results = [solver.solve(problem) for _ in range(120)]
            assert results[0].found
            assert results[-1].status is QpStatus.ITERATION_LIMIT
            assert results[-1].iterations == 0
            assert "spent" in results[-1].reason
            # ProxQP ends after a whole outer iteration
            assert solver.pivots_left >= (-10 if name == "proxqp" else 0)
            pivots += [result.iterations for result in results]
        runs.append(pivots)
    assert runs[0] == runs[1]


@pytest.mark.parametrize("n", [3, 6, 9, 12])
def test_a_degenerate_vertex_is_no_conflict(n: int) -> None:
    """No normal force under friction pyramids: only zero is left, more rows meet there than fit.

    60 rotated problems, seeds 0 to 59.
    """
    pyramid = np.array([[0, 0, 1], [1, 0, -0.5], [-1, 0, -0.5], [0, 1, -0.5], [0, -1, -0.5]])
    rows = np.kron(np.eye(n // 3), pyramid / np.linalg.norm(pyramid, axis=1)[:, None])
    lower = np.tile([0.0, -np.inf, -np.inf, -np.inf, -np.inf], n // 3)
    for seed in range(60):
        rng = np.random.default_rng(seed)
        rotated = rows @ np.linalg.qr(rng.normal(size=(n, n)))[0]
        linear = 50.0 * rng.normal(size=n)
        problem = QpProblem(
            np.eye(n), linear, np.zeros((0, n)), np.zeros(0), rotated, lower, np.zeros(len(rows))
        )
        result = DualSolver(SETTINGS).solve(problem)
        assert result.status is QpStatus.SOLVED
        assert np.abs(result.x).max() < 1e-8

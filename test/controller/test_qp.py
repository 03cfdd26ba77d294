"""QP solvers: residuals rather than trust in a success flag."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import WrongSize
from ghc_controller.qp import SOLVERS, QpProblem, QpResult, QpStatus, make_solver, residuals


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


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("sizes", [(7, 0, 14), (20, 6, 40), (7, 0, 0)])
def test_kkt_residuals(solver: str, sizes: tuple[int, int, int]) -> None:
    """Primal and dual residual of every answer below 1e-8, also after a change of size."""
    rng = np.random.default_rng(0)
    instance = make_solver(solver)
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
    for name in SOLVERS:
        solver = make_solver(name)
        assert not solver.solve(bad).found
        assert residuals(good, solver.solve(good)).primal < 1e-8


def test_shapes_are_checked() -> None:
    """A matrix that does not fit is named with both shapes."""
    good = _random_qp(np.random.default_rng(3), 4, 0, 3)
    with pytest.raises(WrongSize, match=r"QP matrix C.*\(3, 3\) given, \(3, 4\) expected"):
        QpProblem(good.H, good.g, good.A, good.b, good.C[:, :3], good.l, good.u).check()

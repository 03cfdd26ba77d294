"""Closed-form GHC: which projectors are one, what they protect, and that `ghc` is their law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.problems.closed_form_laws import (
    PROJECTORS,
    ClosedForm,
    generalized_11,
    naive_8,
    product_of_5,
    stacked_6,
)
from ghc_controller.formulations import ControlProblem, FormulationSettings, make_formulation
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array, Bounds

SEED = 10


def _rows(rng: np.random.Generator) -> list[Array]:
    return [rng.normal(size=(3, 10)) for _ in range(3)]


def test_for_one_task_5_6_and_11_are_one_projector_and_8_for_one_row() -> None:
    """To 1e-12, 20 tasks and values of alpha."""
    rng = np.random.default_rng(SEED)
    for _ in range(20):
        task, alpha = rng.normal(size=(3, 8)), rng.uniform(size=1)
        expected = generalized_11([task], alpha)
        for projector in (product_of_5, stacked_6):
            assert np.abs(projector([task], alpha) - expected).max() < 1e-12
        row = task[:1]
        assert np.abs(naive_8([row], alpha) - generalized_11([row], alpha)).max() < 1e-12


def test_only_11_protects_every_task_above_at_any_alpha() -> None:
    """alpha = (1, s, 0): J_1 P = 0 in (11) and (5); (6) needs s = 0 or 1, (8) never has it."""
    rng = np.random.default_rng(SEED)
    for _ in range(20):
        rows = _rows(rng)
        left = {
            (name, share): np.abs(rows[0] @ project(rows, np.array([1.0, share, 0.0]))).max()
            for name, project in PROJECTORS.items()
            for share in (0.5, 1.0)
        }
        for share in (0.5, 1.0):
            assert left["(11), generalized", share] < 1e-12
            assert left["(5), product", share] < 1e-12
            assert left["(8), sum over rows", share] > 1e-2
        assert left["(6), stacked", 1.0] < 1e-12
        assert left["(6), stacked", 0.5] > 1e-3
        strict = np.array([1.0, 1.0, 0.0])
        assert np.abs(rows[1] @ generalized_11(rows, strict)).max() < 1e-12
        assert np.abs(rows[1] @ product_of_5(rows, strict)).max() > 1e-3
        eigenvalues = np.linalg.eigvalsh(naive_8(rows, np.ones(3)))
        assert eigenvalues[0] < -0.1  # no contraction
        eigenvalues = np.linalg.eigvalsh(generalized_11(rows, np.array([1.0, 0.5, 0.2])))
        assert eigenvalues[0] > -1e-12
        assert eigenvalues[-1] < 1.0 + 1e-12


def _free_problem(rng: np.random.Generator, alpha: Array) -> ControlProblem:
    rows = _rows(rng)
    wide = Bounds(np.full(10, -1e9), np.full(10, 1e9))
    root = rng.normal(size=(10, 10))
    return ControlProblem(
        np.vstack(rows),
        rng.normal(size=9),
        np.array([0, 3, 6, 9]),
        Priorities.of(alpha),
        root @ root.T / 10.0 + 0.5 * np.eye(10),
        rng.normal(size=10),
        rng.normal(size=10),
        wide,
        wide,
        wide,
    )


def test_ghc_is_the_closed_form_of_11_where_no_bound_is_active() -> None:
    """Any alpha, moving: to 1e-10, 50 problems."""
    rng = np.random.default_rng(SEED)
    settings = FormulationSettings()
    law, ghc = ClosedForm(generalized_11, settings), make_formulation("ghc", settings)
    for _ in range(50):
        alpha = rng.uniform(size=(3, 3))
        np.fill_diagonal(alpha, 0.0)
        problem = _free_problem(rng, alpha)
        a, b = law.solve(problem), ghc.solve(problem)
        assert not b.qp_solved
        scale = max(1.0, float(np.abs(b.acceleration).max()))
        assert np.abs(a.acceleration - b.acceleration).max() < 1e-10 * scale
        assert a.torque == pytest.approx(b.torque, rel=1e-9, abs=1e-9)


def test_static_projection_disturbs_the_first_task_and_the_closed_form_does_not() -> None:
    """Another target of the last task: J_1 x moves by more than 1e-3 in 20 problems, or not."""
    rng = np.random.default_rng(SEED)
    settings = FormulationSettings()
    strict = np.tril(np.ones((3, 3)), -1)
    for _ in range(20):
        problem = _free_problem(rng, strict)
        moved = problem.target.copy()
        moved[6:] += 3.0
        for static in (False, True):
            law = ClosedForm(generalized_11, settings, static)
            before = law.solve(problem).acceleration
            after = law.solve(replace(problem, target=moved)).acceleration
            change = problem.jacobian[:3] @ (after - before)
            assert (np.abs(change).max() > 1e-3) == static

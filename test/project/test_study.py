"""Every study runs in small, and what studies judge with is itself checked."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import nnls

from benchmarks.code_version import commit, other_code, sources
from benchmarks.problems.bounded_problems import bounded_problems
from benchmarks.problems.conflicting_targets import APART, conflicting_pairs
from benchmarks.problems.problem_check import is_feasible, violation
from benchmarks.problems.reference_cascade import bounded_least_squares
from benchmarks.ramps.share_ramps import KINDS, orders_of
from benchmarks.random_tasks import random_matrix, strict_matrix
from benchmarks.studies import StudyWithFigure, load_studies
from benchmarks.study import main
from benchmarks.study_results import rounded, spread, store, write_document
from ghc_controller.formulations import FORMULATIONS, SolutionStatus, make_formulation
from ghc_controller.hierarchy import PriorityMatrix, matrix_from_hierarchy
from ghc_controller.robot.library import find_robot
from ghc_controller.robot.robot import load_robot_config
from ghc_controller.types import Bounds

ROOT = Path(__file__).resolve().parents[2]
STUDIES = load_studies()
W = 1e-2  # [-] damping of the random problems


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_runs_in_small_and_shows_what_it_measured(name: str, tmp_path: Path) -> None:
    study = STUDIES[name]
    assert set(study.FORMULATIONS) <= set(FORMULATIONS)
    formulation = study.FORMULATIONS[0]
    folder = tmp_path / "study"
    result = store(folder, name, study.run(True, (formulation,)))
    assert set(result) == {"facts", "formulations", "sources", "commit"}
    assert set(result["formulations"]) == {formulation}
    table = study.table(result)
    sentence, _, rows = table.partition("\n\n")
    assert sentence.endswith(".")
    assert formulation in rows
    widths = {line.count("|") for line in rows.partition("\n\n")[0].splitlines()}
    assert len(widths) == 1  # every row has the cells of the head
    write_document(folder, STUDIES)
    text = folder.with_suffix(".md").read_text(encoding="utf-8")
    assert table in text
    if isinstance(study, StudyWithFigure):
        assert f"](figures/{study.FIGURE})" in text
        assert 5_000 < (tmp_path / "figures" / study.FIGURE).stat().st_size < 60_000


@pytest.mark.parametrize("name", ["random_bounded", "continuity", "duplicates"])
def test_a_study_gives_the_same_figures_twice(name: str) -> None:
    first, second = (rounded(STUDIES[name].run(True, ("ghc",))) for _ in range(2))
    assert first == second


def test_the_committed_results_are_those_of_studies_and_small() -> None:
    for path in (ROOT / "docs" / "study").glob("*.json"):
        result = json.loads(path.read_text(encoding="utf-8"))
        assert STUDIES[path.stem].table(result)
        assert path.stat().st_size < 30_000


def test_one_formulation_can_be_run_alone(tmp_path: Path) -> None:
    facts = {"seed": 1}
    store(tmp_path, "some", {"facts": facts, "formulations": {"a": {"x": 1.0}, "b": {"x": 2.0}}})
    merged = store(tmp_path, "some", {"facts": facts, "formulations": {"b": {"x": 3.0}}})
    assert merged["formulations"] == {"a": {"x": 1.0}, "b": {"x": 3.0}}
    file = tmp_path / "some.json"
    file.write_text(file.read_text(encoding="utf-8").replace(merged["sources"], "older"))
    after = store(tmp_path, "some", {"facts": facts, "formulations": {"a": {"x": 1.0}}})
    assert set(after["formulations"]) == {"a"}  # b was measured with other code
    other = {"facts": {"seed": 2}, "formulations": {"b": {"x": 3.0}}}
    assert set(store(tmp_path, "some", other)["formulations"]) == {"b"}


def test_results_of_older_code_are_named_with_their_commit() -> None:
    assert other_code({"a": {"sources": sources()}}) == ""
    older = {"sources": "older", "commit": "1234567 (2026-01-01)"}
    sentence = other_code({"a": {"sources": sources()}, "b": older, "c": {}})
    assert "`b`: 1234567 (2026-01-01)" in sentence
    assert "`c`: a commit that was not recorded" in sentence
    assert "`a`" not in sentence


def test_a_result_names_the_commit_that_is_checked_out(tmp_path: Path) -> None:
    stored = store(tmp_path, "some", {"facts": {}, "formulations": {}})
    assert stored["commit"] == commit()
    assert re.fullmatch(r"([0-9a-f]{7,} \(\d{4}-\d\d-\d\d\)( with changes)?)?", commit())


def test_results_are_short_and_valid_numbers() -> None:
    value = {"a": [1.23456789, np.float64(np.nan)], "b": np.int64(3), "c": np.inf, "d": True}
    assert rounded(value) == {"a": [1.235, None], "b": 3, "c": None, "d": True}
    assert rounded(spread([])) == {"median": None, "p95": None, "max": None}


def test_the_program_writes_to_the_folder_that_it_is_given(tmp_path: Path) -> None:
    arguments = ["duplicates", "--quick", "--formulation", "hqp", "--output", str(tmp_path / "r")]
    assert main(arguments) == 0
    assert {path.name for path in tmp_path.rglob("*.*")} == {"r.md", "duplicates.json"}
    with pytest.raises(SystemExit):
        main(["no_such_study"])


def test_strict_matrices_are_those_of_hierarchy_strings() -> None:
    tasks = ("a", "b", "c", "d")
    for order, text in (((2, 0, 1, 3), "c > a > b > d"), ((3, 1), "d > b")):
        expected = matrix_from_hierarchy(tasks, text).alpha
        np.testing.assert_array_equal(strict_matrix(order, 4), expected)


def test_random_matrices_are_priority_matrices_of_every_kind() -> None:
    rng = np.random.default_rng(0)
    kinds = set()
    for _ in range(60):
        alpha, kind = random_matrix(rng, 5)
        PriorityMatrix(tuple("abcde"), alpha)
        kinds.add(kind)
    assert kinds == {"order", "cycle", "values"}


@pytest.mark.parametrize("kind", KINDS)
def test_ramps_go_through_orders_of_the_tasks(kind: str) -> None:
    order = (3, 1, 0, 2)
    turns = orders_of(kind, order, np.random.default_rng(0))
    assert len(turns) >= 2
    for tasks, share in turns:
        assert set(tasks) <= set(order)
        assert len(set(tasks)) == len(tasks)
        assert 0.0 < share <= 1.0


def test_the_reference_qp_meets_the_optimality_conditions() -> None:
    """Seed 0: bounds are met, and the gradient is a sum of the active rows, of the right sign."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        n, m = int(rng.integers(3, 20)), int(rng.integers(1, 4))
        A, r = rng.normal(size=(m, n)), 3.0 * rng.normal(size=m)
        C, width = np.vstack([np.eye(n), rng.normal(size=(n, n))]), rng.uniform(0.05, 0.5, 2 * n)
        z = bounded_least_squares(A, r, W, C, -width, width)
        assert z is not None
        reached = C @ z
        assert (np.abs(reached) <= width + 1e-9).all()
        gradient = A.T @ (A @ z - r) + W * z
        active = np.abs(np.abs(reached) - width) < 1e-8
        rows = C[active] * np.sign(reached[active])[:, None]
        rest = nnls(rows.T, -gradient)[1] if active.any() else np.linalg.norm(gradient)
        assert rest < 1e-8 * max(1.0, float(np.linalg.norm(r)))


def test_the_reference_qp_finds_no_point_where_there_is_none() -> None:
    C = np.array([[1.0, 0.0], [1.0, 0.0]])
    lower, upper = np.array([1.0, -np.inf]), np.array([np.inf, 0.0])
    assert bounded_least_squares(np.eye(2), np.ones(2), W, C, lower, upper) is None


def test_the_project_s_cascade_agrees_with_the_reference_where_bounds_are_active() -> None:
    formulation = make_formulation("hqp")
    for case in bounded_problems(12, W):
        problem = case.control_problem()
        problem.check()
        reference, solution = case.hard_cascade(W), formulation.solve(problem)
        assert reference is not None
        assert solution.status is SolutionStatus.SOLVED
        for level in (0, 1):
            error = case.jacobians[level] @ solution.acceleration - case.targets[level]
            excess = np.linalg.norm(error) - reference[1][level]
            assert abs(excess) < 1e-6 * np.linalg.norm(case.targets[level])


def test_violations_are_found_in_the_units_of_the_rows() -> None:
    problem = next(bounded_problems(1, W)).control_problem()
    solution = make_formulation("hqp").solve(problem)
    assert violation(problem, solution) < 1e-6
    wrong = solution._replace(torque=solution.torque + 0.25)
    assert violation(problem, wrong) == pytest.approx(0.25, abs=0.01)


def test_a_problem_without_a_feasible_point_is_told_from_one_with() -> None:
    problem = next(bounded_problems(1, W)).control_problem()
    assert is_feasible(problem)
    n = len(problem.bias)
    far = np.linalg.solve(problem.mass_matrix, problem.torque.upper + 10.0 - problem.bias)
    impossible = replace(problem, acceleration=Bounds(far, far + np.full(n, 1e-3)))
    assert not is_feasible(impossible)


def test_conflicting_targets_are_reachable_alone_and_not_together() -> None:
    robot = load_robot_config(find_robot("kuka_lwr"))
    for pair in conflicting_pairs(robot, 2, seed=3):
        assert pair.apart >= APART
        assert np.linalg.norm(pair.upper) < 1.6  # [m] within the arm's length above the floor

"""task_priority: the identities of Jeong and Chang (2009), on random levels (seed 7)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from strict_problems import (
    CASES,
    difference,
    lexicographic,
    null_basis,
    random_inertia,
    random_levels,
    strict_problem,
)

from ghc_controller.formulations import (
    DampedLevels,
    FormulationSettings,
    Metric,
    make_formulation,
)
from ghc_controller.formulations.baselines.resolved_acceleration import resolved_acceleration
from ghc_controller.formulations.baselines.strict_law import Level
from ghc_controller.formulations.baselines.task_priority import new_directions, task_priority
from ghc_controller.types import Array

TOLERANCE = 1e-8  # [-] rank decision of both sides
SEED = 7
Case = tuple[int, list[int], bool]


def _undamped(order: Sequence[Level]) -> Array:
    return task_priority(order, [0.0] * len(order), TOLERANCE)


def _damped(order: Sequence[Level], w: float) -> Array:
    return task_priority(order, [w] * len(order), TOLERANCE)


def _rows_as_printed(
    order: Sequence[Level], damping: Sequence[float], whole_null_space: bool = False
) -> tuple[Array, Array]:
    """J_E and h_E of (15), (16) and (27); Z_i spans the rows of J_i N_i, or all that is left."""
    n = order[0].jacobian.shape[1]
    used = np.zeros((0, n))
    rows, right = [], []
    for depth, ((jacobian, target), damped) in enumerate(zip(order, damping, strict=True)):
        basis = new_directions(jacobian, used, TOLERANCE)
        chosen = null_basis(used).T if whole_null_space else basis
        if depth == 0 and damped == 0.0:
            rows.append(jacobian)
            right.append(target)
        else:
            rows.append(chosen @ (jacobian.T @ jacobian + damped * np.eye(n)))
            right.append(chosen @ (jacobian.T @ target))
        used = np.vstack([used, basis])
    return np.vstack(rows), np.concatenate(right)


def _misses(order: Sequence[Level], x: Array) -> list[float]:
    return [float(np.linalg.norm(level.jacobian @ x - level.target)) for level in order]


def _nearly_dependent(rng: np.random.Generator, angle: float) -> list[Level]:
    """Two rows, and below them one that leaves their row space by `angle` [rad]."""
    above = Level(rng.normal(size=(2, 7)), np.array([1.0, -1.0]))
    along = above.jacobian.T @ rng.normal(size=2)
    apart = null_basis(above.jacobian)[:, 0]
    return [above, Level((along / np.linalg.norm(along) + angle * apart)[None], np.ones(1))]


@pytest.mark.parametrize("case", CASES)
def test_18_is_the_lexicographic_optimum_of_least_norm(case: Case) -> None:
    """Blocks to 1e-9, J_E^+ h_E as printed to 1e-6 with either reading of Z_i: 30 problems."""
    rng = np.random.default_rng(SEED)
    for _ in range(30):
        order = random_levels(rng, *case)
        expected = lexicographic(order)
        assert difference(_undamped(order), expected) < 1e-9
        for whole in (False, True):
            extended, right = _rows_as_printed(order, [0.0] * len(order), whole)
            x = np.linalg.pinv(extended, rcond=1e-12) @ right
            assert difference(x, expected) < 1e-6


@pytest.mark.parametrize("case", CASES)
def test_18_is_28_and_resolved_acceleration(case: Case) -> None:
    """With one rank decision, singular or not, to 1e-8."""
    rng = np.random.default_rng(SEED)
    for _ in range(30):
        order = random_levels(rng, *case)
        other = resolved_acceleration(order, [0.0] * len(order), TOLERANCE)
        assert difference(_undamped(order), other) < 1e-8


def test_tasks_that_can_all_be_met_are_met() -> None:
    """Theorem 2: no algorithmic error, 50 problems of 28 joints and 12 rows."""
    rng = np.random.default_rng(SEED)
    for _ in range(50):
        order = random_levels(rng, 28, [4, 2, 3, 3], False)
        assert max(_misses(order, _undamped(order))) < 1e-9


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("w", [1e-1, 1e-2, 1e-4])
def test_27_with_level_1_damped_is_balanced_and_resolved_acceleration_with_sr_inverse(
    case: Case, w: float
) -> None:
    """J_E as printed, blocks, SR inverse with undamped null spaces, and `balanced`, to 1e-7."""
    rng = np.random.default_rng(SEED)
    balanced = make_formulation("balanced", FormulationSettings(regularization=w))
    for _ in range(10):
        order = random_levels(rng, *case)
        blocks = _damped(order, w)
        extended, right = _rows_as_printed(order, [w] * len(order))
        printed = np.linalg.pinv(extended, rcond=1e-13) @ right
        n = order[0].jacobian.shape[1]
        problem = strict_problem(order, np.eye(n), np.zeros(n))
        assert difference(blocks, printed) < 1e-7
        assert (
            difference(resolved_acceleration(order, [w] * len(order), TOLERANCE), printed) < 1e-7
        )
        assert difference(balanced.solve(problem).acceleration, printed) < 1e-7


@pytest.mark.parametrize("case", CASES)
def test_27_is_hqp_where_no_bound_is_active(case: Case) -> None:
    """To 1e-3: hqp drops singular values below 1e-4 of the largest."""
    rng = np.random.default_rng(SEED)
    hqp = make_formulation("hqp")
    for _ in range(10):
        order = random_levels(rng, *case)
        n = order[0].jacobian.shape[1]
        problem = strict_problem(order, np.eye(n), np.zeros(n))
        assert difference(hqp.solve(problem).acceleration, _damped(order, 1e-2)) < 1e-3


@pytest.mark.parametrize("conflict", [False, True])
def test_27_with_the_whole_null_space_takes_from_level_1(conflict: bool) -> None:
    """Level 1 is missed by more than 1e-4 at lambda = 0.1; with r_i rows as in (12) by nothing."""
    rng = np.random.default_rng(SEED)
    whole, compact = [], []
    for _ in range(30):
        order = random_levels(rng, 12, [2, 3, 2], conflict)
        damping = [0.0, 0.1, 0.1]
        extended, right = _rows_as_printed(order, damping, whole_null_space=True)
        assert len(extended) > 12
        whole.append(_misses(order, np.linalg.pinv(extended) @ right)[0])
        compact.append(_misses(order, task_priority(order, damping, TOLERANCE))[0])
    assert max(whole) > 1e-4
    assert max(compact) < 1e-9


def test_rows_cannot_be_split_into_feasible_and_conflicting_ones() -> None:
    """(19) to (21) hold after a rotation of the task only: picking a row is 20 % worse."""
    rng = np.random.default_rng(SEED)
    first, other = rng.normal(size=(1, 6)), rng.normal(size=6)
    rows = np.vstack([other, other + first[0]])
    above, task = Level(first, rng.normal(size=1)), Level(rows, rng.normal(size=2))
    for row in rows:  # no row depends on level 1, although one direction of the two does
        assert np.linalg.matrix_rank(np.vstack([first, row])) == 2
    best = _undamped([above, task])
    for row in (0, 1):
        picked = _undamped([above, Level(rows[[row]], task.target[[row]])])
        assert _misses([task], picked)[0] > 1.2 * _misses([task], best)[0]
    null = null_basis(first)
    turn = np.linalg.svd(rows @ null @ null.T)[0][:, :1].T  # J_2 N_2 = U S V^T
    stacked = np.vstack([first, turn @ rows])
    rotated = np.linalg.pinv(stacked) @ np.concatenate([above.target, turn @ task.target])
    assert difference(rotated, best) < 1e-10


def test_two_passes_keep_digits_near_an_algorithmic_singularity() -> None:
    """Angle 1e-7 between two levels: level 2 is met to 1e-8, after one pass 100 times worse."""
    rng = np.random.default_rng(SEED)
    for _ in range(10):
        order = _nearly_dependent(rng, 1e-7)
        above, (row,) = order[0].jacobian, order[1].jacobian
        x = task_priority(order, [0.0, 0.0], 1e-14)
        used = new_directions(above, np.zeros((0, 7)), 1e-14)
        once = row - used.T @ (used @ row)
        once /= np.linalg.norm(once)
        x1 = _undamped(order[:1])
        other = x1 + once * (1.0 - row @ x1) / (row @ once)
        disturbed = float(np.linalg.norm(above @ (other - x1)))
        assert max(_misses(order, x)) < 1e-8
        assert disturbed > 100.0 * max(_misses(order, x))


def test_damping_bounds_accelerations_near_a_singularity_and_18_does_not() -> None:
    """|x| grows as 1 / angle in (18); in (27) it stays below |r| / (2 sqrt(lambda)) per level."""
    lengths = []
    for angle in (1e-2, 1e-4, 1e-6):
        order = _nearly_dependent(np.random.default_rng(SEED), angle)
        lengths.append(float(np.linalg.norm(_undamped(order))))
        x1 = _undamped(order[:1])
        missing = abs(float((order[1].jacobian @ x1 - 1.0)[0]))
        x = task_priority(order, [0.0, 1e-2], TOLERANCE)
        assert np.linalg.norm(x - x1) <= missing / (2.0 * np.sqrt(1e-2)) + 1e-12
    assert lengths[1] > 50.0 * lengths[0]
    assert lengths[2] > 50.0 * lengths[1]


def test_each_metric_makes_its_own_norm_least() -> None:
    """|x|, x^T M x and |M x| = |tau - h| grow by any step that keeps the tasks: 200 steps."""
    rng = np.random.default_rng(SEED)
    mass, order = random_inertia(rng, 12), random_levels(rng, 12, [2, 3, 2], False)
    problem = strict_problem(order, mass, rng.normal(size=12))
    root = np.linalg.cholesky(mass).T
    null = null_basis(problem.jacobian)
    norms = {Metric.ACCELERATION: np.eye(12), Metric.INERTIA: root, Metric.TORQUE: mass}
    for metric, matrix in norms.items():
        settings = FormulationSettings(metric=metric, damped_levels=DampedLevels.NONE)
        x = make_formulation("task_priority", settings).solve(problem).acceleration
        assert max(_misses(order, x)) < 1e-9
        for _ in range(200):
            other = x + 0.1 * null @ rng.normal(size=null.shape[1])
            assert np.linalg.norm(matrix @ other) >= np.linalg.norm(matrix @ x) - 1e-12


@pytest.mark.parametrize("conflict", [False, True])
def test_metrics_agree_where_the_last_level_takes_all_that_is_left(conflict: bool) -> None:
    """To 1e-6, since nothing is left to be made least."""
    rng = np.random.default_rng(SEED)
    order = random_levels(rng, 9, [3, 3, 9], conflict)
    problem = strict_problem(order, random_inertia(rng, 9), np.zeros(9))
    answers = [
        make_formulation(
            "task_priority", FormulationSettings(metric=metric, damped_levels=DampedLevels.NONE)
        )
        .solve(problem)
        .acceleration
        for metric in Metric
    ]
    assert difference(answers[1], answers[0]) < 1e-6
    assert difference(answers[2], answers[0]) < 1e-6

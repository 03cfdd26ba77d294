"""Hierarchical least squares at velocity level: optimality, bounds, memory, errors."""

from __future__ import annotations

import numpy as np
import pytest
from model_states import make_model, random_state
from scipy.optimize import lsq_linear, nnls

from ghc_controller.errors import InvalidValue, UnknownName, WrongSize
from ghc_controller.kinematics import (
    MODELS,
    HierarchySolver,
    KinematicSettings,
    Level,
    LevelRows,
    TaskSolver,
    TrustRegion,
)
from ghc_controller.kinematics.level_kernels import positive_root, structured_update
from ghc_controller.kinematics.second_order import SecondOrderTerms
from ghc_controller.kinematics.step_record import StepRecord
from ghc_controller.tasks.frame import FrameOrientationTask, FramePositionTask
from ghc_controller.types import Array

N = 7
WIDE = 1e3  # [rad] a trust region that no step reaches
BOXED = tuple(name for name in MODELS if name != "adls")


def _levels(rng: np.random.Generator, sizes: tuple[int, ...] = (3, 2)) -> list[LevelRows]:
    return [LevelRows.equalities(rng.normal(size=(m, N)), rng.normal(size=m)) for m in sizes]


def _kernel(rows: Array) -> Array:
    _, s, Vt = np.linalg.svd(rows)
    return Vt[int((s > 1e-9).sum()) :].T


@pytest.mark.parametrize("model", ["gn", "dhqp", "adls"])
def test_without_bounds_the_step_is_that_of_the_textbook(model: str) -> None:
    """Seed 0: the null-space recursion; levels without conflict, damping 0."""
    rng = np.random.default_rng(0)
    settings = KinematicSettings(model=model, trust_region=WIDE, damping=0.0)
    for _ in range(20):
        levels = _levels(rng)
        first, second = levels
        step = HierarchySolver(N, settings).solve(levels)
        x = np.linalg.pinv(first.jacobian) @ first.lower
        P = np.eye(N) - np.linalg.pinv(first.jacobian) @ first.jacobian
        x = x + np.linalg.pinv(second.jacobian @ P) @ (second.lower - second.jacobian @ x)
        np.testing.assert_allclose(step, x, atol=1e-6 * max(1.0, float(np.abs(x).max())))


def test_levels_are_optimal_one_after_the_other_under_bounds() -> None:
    """Seed 1: level 1 has the least residual of all bounded steps; level 2 is stationary in the
    null space of level 1, with multipliers of the right sign at the bounds that are reached."""
    rng = np.random.default_rng(1)
    reached = 0
    for _ in range(60):
        levels = _levels(rng, (3, 3))
        radius = rng.uniform(0.1, 0.6)
        solver = HierarchySolver(N, KinematicSettings(model="gn", trust_region=radius))
        x = solver.solve(levels)
        assert np.abs(x).max() <= radius + 1e-9
        J, e = levels[0].jacobian, levels[0].lower
        best = lsq_linear(J, e, (-radius, radius), tol=1e-14)
        residual = float(np.linalg.norm(J @ x - e))
        assert residual == pytest.approx(np.sqrt(2.0 * best.cost), abs=1e-6)
        J2, e2 = levels[1].jacobian, levels[1].lower
        space = _kernel(J)
        active = np.abs(x) > radius - 1e-9
        reached += bool(active.any())
        gradient = space.T @ (J2.T @ (J2 @ x - e2))
        rows = (np.eye(N)[active] * np.sign(x[active])[:, None]) @ space
        rest = nnls(rows.T, -gradient)[1] if active.any() else float(np.linalg.norm(gradient))
        assert rest < 1e-5
    assert reached > 40


def test_a_step_is_the_least_one_that_its_levels_leave() -> None:
    rng = np.random.default_rng(2)
    levels = _levels(rng)
    x = HierarchySolver(N, KinematicSettings(model="gn", trust_region=WIDE)).solve(levels)
    space = _kernel(np.vstack([level.jacobian for level in levels]))
    assert np.abs(space.T @ x).max() < 1e-9


@pytest.mark.parametrize("model", BOXED)
def test_inequalities_above_are_kept_and_their_excess_is_least(model: str) -> None:
    """Seed 3: rows that can be met are met by all levels below; of rows that contradict the
    trust region the excess is that of a bounded least-squares problem (gn)."""
    rng = np.random.default_rng(3)
    settings = KinematicSettings(model=model, trust_region=0.3)
    violated = 0
    for _ in range(30):
        J = rng.normal(size=(2, N))
        lower = rng.uniform(-0.5, 1.5, 2)
        box = LevelRows(J, lower, lower + 0.3, False)
        x = HierarchySolver(N, settings).solve([box, *_levels(rng)], own=_linear, term=_linear)
        assert np.abs(x).max() <= 0.3 + 1e-9
        excess = np.maximum(J @ x - box.upper, 0.0) + np.maximum(box.lower - J @ x, 0.0)
        best = _least_excess(J, box.lower, box.upper, 0.3)
        violated += best > 1e-3
        if model == "dhqp":  # its damping gives rows up
            assert float(np.linalg.norm(excess)) > best - 1e-5
        else:
            assert float(np.linalg.norm(excess)) == pytest.approx(best, abs=1e-5)
    assert 3 < violated < 27


def _linear(level: int, weights: Array) -> Array:
    """Second-order term of rows that are linear."""
    return np.zeros((N, N))


def _least_excess(J: Array, lower: Array, upper: Array, radius: float) -> float:
    """min over s in [lower, upper], |x| <= radius of |J x - s|."""
    rows = np.hstack([J, -np.eye(2)])
    low = np.concatenate([np.full(N, -radius), lower])
    high = np.concatenate([np.full(N, radius), upper])
    return float(np.sqrt(2.0 * lsq_linear(rows, np.zeros(2), (low, high), tol=1e-14).cost))


def test_an_inequality_that_holds_costs_the_levels_below_nothing() -> None:
    rng = np.random.default_rng(4)
    levels = _levels(rng)
    settings = KinematicSettings(model="gn", trust_region=WIDE)
    free = HierarchySolver(N, settings).solve(levels)
    wide = LevelRows(rng.normal(size=(3, N)), np.full(3, -1e3), np.full(3, 1e3), False)
    np.testing.assert_allclose(
        HierarchySolver(N, settings).solve([wide, *levels]), free, atol=1e-9
    )


@pytest.mark.parametrize("model", BOXED)
def test_steps_stay_within_the_trust_region_and_the_joint_limits(model: str) -> None:
    """Seed 5: KUKA, a target out of reach, from a posture near its limits."""
    rng = np.random.default_rng(5)
    robot = make_model("kuka_lwr")
    task = FramePositionTask("tool", robot, robot.frame_names[-1], 1.0, 1.0)
    solver = TaskSolver(robot, [Level(task)], KinematicSettings(model=model, trust_region=0.02))
    q = robot.position_upper - rng.uniform(0.0, 0.05, N)
    for _ in range(100):
        step = solver.step(q, {"tool": np.array([1.5, 1.0, 0.5])})
        assert np.abs(step).max() <= 0.02 + 1e-9
        q = q + step
        assert (q <= robot.position_upper + 1e-9).all()
        assert (q >= robot.position_lower - 1e-9).all()


@pytest.mark.parametrize("model", ["gn_qn", "newton"])
def test_out_of_reach_the_arm_comes_to_rest_at_the_nearest_point(model: str) -> None:
    """Seed 6: KUKA; Gauss-Newton goes on moving, these stop where J^T e = 0."""
    rng = np.random.default_rng(6)
    robot = make_model("kuka_lwr")
    task = FramePositionTask("tool", robot, robot.frame_names[-1], 1.0, 1.0)
    goal = np.array([1.2, 0.9, 1.4])
    start = random_state("kuka_lwr", rng).q * 0.3
    moved = {}
    for name in ("gn", model):
        settings = KinematicSettings(model=name, adapts=name != "gn")
        solver = TaskSolver(robot, [Level(task)], settings, joint_limits=False)
        q = start.copy()
        for _ in range(1500):
            step = solver.step(q, {"tool": goal})
            q = q + step
        moved[name] = float(np.abs(step).max())
        robot.update(q, np.zeros(N))
        J = robot.frame_jacobian(robot.frame_id(task.frame))[:3]
        slope = float(np.abs(J.T @ (goal - task.current(robot))).max())
        if name != "gn":
            assert slope < 1e-4
    assert moved[model] < 1e-4 < 1e-3 < moved["gn"]


def test_the_secant_holds_and_the_matrix_stays_positive() -> None:
    """Seed 7: B dq = y after an update; nothing changes where y^T dq is not positive."""
    rng = np.random.default_rng(7)
    B = np.eye(N)
    updates = 0
    for _ in range(100):
        step, y = rng.normal(size=N), rng.normal(size=N)
        before = B.copy()
        if structured_update(B, y, step, 1e-12):
            np.testing.assert_allclose(B @ step, y, rtol=1e-6, atol=1e-6 * np.abs(B).max())
            updates += 1
            B = np.eye(N) if np.linalg.cond(B) > 1e4 else B
            assert np.linalg.eigvalsh(B).min() > 0.0
        else:
            assert y @ step <= 1e-12
            np.testing.assert_array_equal(B, before)
    assert 20 < updates < 80


def test_an_update_that_would_overflow_is_left_out() -> None:
    B, step, y = np.eye(2), np.array([1e-3, 0.0]), np.array([1e-8, 1e4])
    assert not structured_update(B, y, step, 1e-12)
    np.testing.assert_array_equal(B, np.eye(2))


def test_the_root_is_that_of_the_positive_part() -> None:
    rng = np.random.default_rng(8)
    basis, _ = np.linalg.qr(rng.normal(size=(N, N)))
    values = np.array([-3.0, -1e-3, 0.0, 1e-3, 1.0, 2.0, 50.0])
    root = positive_root(basis @ np.diag(values) @ basis.T)
    assert root.shape == (4, N)
    expected = basis @ np.diag(np.maximum(values, 0.0)) @ basis.T
    np.testing.assert_allclose(root.T @ root, expected, atol=1e-9)


def _record(levels: list[LevelRows], residuals: list[float], changed: list[bool]) -> StepRecord:
    return StepRecord(
        np.zeros(N),
        tuple(level.jacobian for level in levels),
        tuple(np.full(len(lv.jacobian), w) for lv, w in zip(levels, residuals, strict=True)),
        tuple(np.ones(len(level.jacobian), dtype=np.bool_) for level in levels),
        tuple(changed),
        {},
    )


def test_memory_starts_anew_from_the_level_that_changes() -> None:
    """Seed 9: a switch or a new active set of level 2 leaves level 1 alone and renews level 3."""
    rng = np.random.default_rng(9)
    levels = _levels(rng, (2, 2, 2))
    fresh = SecondOrderTerms(KinematicSettings()).roots(levels, None, None, None)
    for residuals, changed in (((1, 0, 1), (False,) * 3), ((1, 1, 1), (False, True, False))):
        terms = SecondOrderTerms(KinematicSettings())
        terms.roots(levels, None, None, None)
        for B in terms._B:
            B *= 2.0  # what the secant has learned
        roots = terms.roots(levels, _record(levels, list(residuals), list(changed)), None, None)
        assert terms.augmented == tuple(w == 1 for w in residuals)
        for index, expected in enumerate((2.0, 1.0, 1.0)):
            root, new = roots[index], fresh[index]
            if root is not None and new is not None:
                np.testing.assert_allclose(root.T @ root, expected * new.T @ new, atol=1e-9)


def test_the_first_matrix_is_the_sum_over_the_chains_above() -> None:
    """Eq. 18 without J^T J: max(mu, 1/2 |e_i|^2) on the coordinates of each chain."""
    J1, J2 = np.zeros((1, N)), np.zeros((1, N))
    J1[0, :3], J2[0, 2:5] = 1.0, -2.0
    levels = [
        LevelRows.equalities(J1, np.array([2.0])),
        LevelRows.equalities(J2, np.array([1e-4])),
    ]
    roots = SecondOrderTerms(KinematicSettings()).roots(levels, None, None, None)
    first, second = (root.T @ root for root in roots if root is not None)
    np.testing.assert_allclose(np.diag(first), [2, 2, 2, 0, 0, 0, 0], atol=1e-12)
    added = np.array([0, 0, 1e-3, 1e-3, 1e-3, 0, 0])
    np.testing.assert_allclose(np.diag(second), np.diag(first) + added, atol=1e-12)


def test_multipliers_balance_the_gradient_of_their_level() -> None:
    """Seed 10: J_l^T w_l + B_l dq is a sum of the rows held by the levels above, where joints are
    free; and lambda_{l,l} = w_l."""
    rng = np.random.default_rng(10)
    levels = _levels(rng, (3, 5))
    solver = HierarchySolver(N, KinematicSettings(trust_region=WIDE, adapts=False))
    x = solver.solve(levels)
    roots = SecondOrderTerms(solver.settings).roots(levels, None, None, None)
    assert solver.last is not None
    w = solver.last.residuals[1]
    np.testing.assert_array_equal(solver.last.multipliers[(1, 1)], w)
    first, second = roots
    assert first is not None and second is not None
    gradient = levels[1].jacobian.T @ w + second.T @ (second @ x)
    left = -gradient - levels[0].jacobian.T @ solver.last.multipliers[(0, 1)]
    share = np.linalg.lstsq(first.T, left, rcond=None)[0]  # multipliers of R_1 dq
    np.testing.assert_allclose(first.T @ share, left, atol=1e-9)


def test_a_joint_that_oscillates_gets_a_smaller_radius_and_recovers() -> None:
    region = TrustRegion(2, 0.01, adapts=True)
    for k in range(12):
        region.observe(np.array([(-1.0) ** k, 1.0]))
    assert region.radii[0] < 1e-6
    assert region.radii[1] == 0.01
    for _ in range(1000):
        region.observe(np.array([1.0, 1.0]))
    np.testing.assert_allclose(region.radii, 0.01)
    region.observe(np.array([-1.0, 1.0]))  # the first change after many calm steps
    assert region.radii[0] == pytest.approx(0.01 / 1.2)


def test_a_fixed_trust_region_does_not_adapt() -> None:
    region = TrustRegion(1, 0.01, adapts=False)
    for k in range(20):
        region.observe(np.array([(-1.0) ** k]))
    assert region.radii[0] == 0.01


def test_after_a_reset_the_steps_are_those_of_a_new_solver() -> None:
    rng = np.random.default_rng(11)
    series = [_levels(rng) for _ in range(5)]
    solver = HierarchySolver(N)
    first = [solver.solve(levels) for levels in series]
    solver.reset()
    for before, levels in zip(first, series, strict=True):
        np.testing.assert_array_equal(solver.solve(levels), before)


def test_what_cannot_be_done_is_rejected() -> None:
    rng = np.random.default_rng(12)
    levels = _levels(rng)
    with pytest.raises(UnknownName, match="gn_qn"):
        KinematicSettings(model="bfgs")
    with pytest.raises(InvalidValue, match="trust_region"):
        KinematicSettings(trust_region=0.0)
    box = LevelRows(np.eye(N), -np.ones(N), np.ones(N), False)
    adls = HierarchySolver(N, KinematicSettings(model="adls"))
    with pytest.raises(InvalidValue, match="adls"):
        adls.solve([box])
    with pytest.raises(InvalidValue, match="adls"):
        adls.solve(levels, np.full(N, -1.0), np.full(N, 1.0))
    solver = HierarchySolver(N)
    solver.solve(levels)
    with pytest.raises(InvalidValue, match="number of levels"):
        solver.solve(levels[:1])
    with pytest.raises(InvalidValue, match="lower <= upper"):
        LevelRows(np.eye(2), np.ones(2), np.zeros(2), False)
    with pytest.raises(WrongSize):
        LevelRows(np.eye(2), np.ones(3), np.ones(3), True)
    with pytest.raises(InvalidValue, match="newton"):
        HierarchySolver(N, KinematicSettings(model="newton")).solve(levels)


def test_targets_are_checked_against_their_levels() -> None:
    robot = make_model("kuka_lwr")
    frame = robot.frame_names[-1]
    position = FramePositionTask("tool", robot, frame, 1.0, 1.0)
    with pytest.raises(InvalidValue, match="orientation"):
        Level(FrameOrientationTask("turn", robot, frame, 1.0, 1.0), bounded=True)
    with pytest.raises(InvalidValue):
        Level()
    q = np.zeros(N)
    with pytest.raises(UnknownName, match="tool"):
        TaskSolver(robot, [Level(position)]).step(q, {})
    with pytest.raises(InvalidValue, match="reference"):
        TaskSolver(robot, [Level(position)]).step(q, {"tool": (np.zeros(3), np.ones(3))})
    with pytest.raises(InvalidValue, match="lower"):
        TaskSolver(robot, [Level(position, bounded=True)]).step(q, {"tool": np.zeros(3)})

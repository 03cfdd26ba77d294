"""The structured solves find what a general solver finds for the same QP written out."""

from __future__ import annotations

import numpy as np
import pytest

from ghc_controller.errors import InvalidValue
from ghc_controller.qp import make_solver, residuals
from ghc_controller.types import Array
from ghc_mpc_constraints.previews import force_bound_qp, motion_qp
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundQp, ForceBoundWeights
from ghc_mpc_constraints.previews.horizon import Horizon
from ghc_mpc_constraints.previews.motion_qp import MotionQp
from ghc_mpc_constraints.previews.motion_weights import dynamic_weights

HORIZON = Horizon.of(0.01, 0.6)
STEPS = HORIZON.steps


def _random_bounds(rng: np.random.Generator) -> tuple[Array, Array]:
    jumps = np.sort(rng.integers(0, STEPS, 5))
    segment = np.searchsorted(jumps, np.arange(STEPS), side="right")
    lower, upper = np.sort(rng.uniform(0.0, 50.0, (2, 6)), axis=0)
    upper[rng.random(6) < 0.2] = 0.0
    return np.minimum(lower, upper)[segment], upper[segment]


def test_force_bounds_equal_the_general_solver() -> None:
    """200 random previews: same bounds to 1e-8 N, KKT residuals of that answer below 1e-8."""
    rng = np.random.default_rng(1)
    qp = ForceBoundQp(HORIZON, ForceBoundWeights(0.1, 0.02))
    solver = make_solver("daqp")
    for _ in range(200):
        lower, upper = _random_bounds(rng)
        start = (float(lower[0]), float(upper[0]))
        answer = qp.solve(start, lower, upper)
        problem = qp.problem(start, lower, upper)
        problem.check()
        expected = solver.solve(problem)
        assert residuals(problem, expected).primal < 1e-8
        assert answer is not None
        assert np.allclose(np.concatenate(answer[::-1]), expected.x, rtol=0.0, atol=1e-8)
    assert qp.second.asked == 0


@pytest.mark.parametrize("weighted", [False, True])
def test_motion_equals_the_general_solver(weighted: bool) -> None:
    """100 random previews: same positions to 1e-8 m, cost no higher, no bound passed."""
    rng = np.random.default_rng(2)
    qp, solver = MotionQp(HORIZON, 1e-5), make_solver("daqp")
    for _ in range(100):
        raw = np.repeat(rng.uniform(0.1, 0.5, 3), STEPS // 3)
        weights = dynamic_weights(raw) if weighted else np.ones(STEPS)
        limit = np.full(STEPS, np.inf) if rng.random() < 0.2 else raw
        state = np.array([raw[0], 0.2 * rng.normal(), 0.5 * rng.normal()])
        jerk = qp.solve(state, raw, weights, limit)
        problem = qp.problem(state, raw, weights, limit)
        problem.check()
        expected = solver.solve(problem)
        assert jerk is not None
        assert np.allclose(problem.C @ jerk, problem.C @ expected.x, rtol=0.0, atol=1e-8)
        assert (problem.C @ jerk <= problem.u + 1e-8).all()
        costs = [0.5 * x @ problem.H @ x + problem.g @ x for x in (jerk, expected.x)]
        assert costs[0] <= costs[1] + 1e-8 * (1.0 + abs(costs[1]))
    assert qp.second.asked == 0


def test_second_opinion_where_the_structured_solve_gives_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The general solver takes over, is counted, and finds the same."""
    rng = np.random.default_rng(3)
    force, motion = ForceBoundQp(HORIZON, ForceBoundWeights()), MotionQp(HORIZON, 1e-5)
    lower, upper = _random_bounds(rng)
    raw = np.linspace(0.4, 0.2, STEPS)
    state = np.array([0.4, 0.0, 0.0])
    before = force.solve((lower[0], upper[0]), lower, upper)
    jerk = motion.solve(state, raw, np.ones(STEPS), raw)
    monkeypatch.setattr(
        force_bound_qp.native, "force_bounds", lambda *_: (np.full((2, STEPS), np.nan), False)
    )
    monkeypatch.setattr(
        motion_qp.native, "bounded_motion", lambda *_: (np.full(STEPS, np.nan), False)
    )
    after = force.solve((lower[0], upper[0]), lower, upper)
    assert before is not None
    assert after is not None
    assert np.allclose(before, after, rtol=0.0, atol=1e-8)
    again = motion.solve(state, raw, np.ones(STEPS), raw)
    assert jerk is not None
    assert again is not None
    response = motion.problem(state, raw, np.ones(STEPS), raw).C
    assert np.allclose(response @ jerk, response @ again, rtol=0.0, atol=1e-8)
    assert (force.second.asked, motion.second.asked) == (1, 1)


@pytest.mark.parametrize("weight", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_weights_are_refused(weight: float) -> None:
    with pytest.raises(InvalidValue, match=r"upper_rate_weight.*above 0 expected"):
        ForceBoundWeights(upper_rate_weight=weight)
    with pytest.raises(InvalidValue, match=r"jerk_weight.*above 0 expected"):
        MotionQp(HORIZON, weight)

"""References, previews and plans of the core against plain formulas in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from ghc_controller.core import native
from ghc_controller.numerics.rotation import (
    angular_motion,
    matrix_from_quaternion,
    quaternion_product,
    rotation_exp,
)
from ghc_controller.qp import QpProblem
from ghc_controller.types import Array
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundQp, ForceBoundWeights
from ghc_mpc_constraints.previews.horizon import Horizon
from ghc_mpc_constraints.previews.motion_qp import MotionQp


@pytest.mark.parametrize("length", [1e-6, 1e-2, 1.0, 3.0])
def test_a_turned_motion_is_that_of_the_rotation_vector(length: float) -> None:
    rng = np.random.default_rng(0)
    start, p = rng.normal(size=4), rng.normal(size=3)
    start, p = start / np.linalg.norm(start), length * p / np.linalg.norm(p)
    rate, change = rng.normal(size=(2, 3))
    quaternion = quaternion_product(start, rotation_exp(p))
    rotation = matrix_from_quaternion(quaternion)
    found = native.turned_motion(start, p, rate, change)
    np.testing.assert_allclose(found[0], quaternion, atol=1e-14)
    for one, own in zip(found[1:], angular_motion(p, rate, change), strict=True):
        np.testing.assert_allclose(one, rotation @ own, atol=1e-12)


def test_polynomials_and_integrated_jerks() -> None:
    """A jerk that stays gives the cubic that its state begins."""
    rng = np.random.default_rng(1)
    state, jerk, step = rng.normal(size=(3, 3)), rng.normal(size=3), 0.05
    coefficients = np.zeros((6, 3))
    coefficients[:4] = state[0], state[1], state[2] / 2.0, jerk / 6.0
    jerks = np.tile(jerk, (8, 1))
    states = native.integrate(state, jerks, step)
    for j in range(9):
        np.testing.assert_allclose(states[j], native.evaluate(coefficients, j * step), atol=1e-13)
    middle = native.state_at(state, jerks, step, 0.17)
    np.testing.assert_allclose(middle, native.evaluate(coefficients, 0.17), atol=1e-13)
    ended = native.state_at(state, jerks, step, 9.0)
    np.testing.assert_allclose(ended[0], states[-1, 0])
    assert not ended[1:].any()


@pytest.mark.parametrize("interpolate", [False, True])
def test_bounds_between_points(interpolate: bool) -> None:
    """Held outside of the preview; one point holds everywhere."""
    points = np.random.default_rng(2).normal(size=(3, 6))
    for place in (-1.0, 0.0, 2.25, 4.0, 4.9, 5.0, 7.0):
        at = np.clip(place if interpolate else np.floor(place), 0.0, 5.0)
        wanted = [np.interp(at, np.arange(6), row) for row in points]
        low, high = native.bounds_at(points, points + 1.0, place, interpolate)
        np.testing.assert_allclose(low, wanted, atol=1e-14)
        np.testing.assert_allclose(high, np.add(wanted, 1.0), atol=1e-14)
    one = np.array([[3.0]])
    assert native.bounds_at(one, one, 0.4, interpolate)[0] == 3.0


def _check(problem: QpProblem, x: Array) -> int:
    """x is the optimum: multipliers >= 0 of its active rows carry its gradient; their number."""
    value = problem.C @ x
    assert np.all((value < problem.u + 1e-7) & (value > problem.l - 1e-7))
    active = np.vstack([problem.C[value > problem.u - 1e-7], -problem.C[value < problem.l + 1e-7]])
    gradient = problem.H @ x + problem.g
    missing = nnls(active.T, -gradient)[1] if len(active) else np.linalg.norm(gradient)
    assert missing < 1e-7 * max(1.0, np.abs(problem.H @ x).max())
    return len(active)


@pytest.mark.parametrize("seed", range(6))
def test_plans_are_the_optima_of_their_dense_problems(seed: int) -> None:
    """By their multipliers; some bounds are active."""
    rng = np.random.default_rng(seed)
    horizon = Horizon.of(0.01, 0.3)
    steps = horizon.steps
    motion = MotionQp(horizon, 1e-5)
    raw = 0.2 * np.sin(np.linspace(0.0, rng.uniform(2.0, 9.0), steps))
    limit = np.where(np.arange(steps) > steps // 2, 0.05, np.inf)
    given = np.zeros(3), raw, 10.0 ** rng.uniform(-3.0, 0.0, steps), limit
    jerk = motion.solve(*given)
    assert jerk is not None
    assert motion.second.asked == 0
    _check(motion.problem(*given), jerk)

    forces = ForceBoundQp(horizon, ForceBoundWeights())
    raw_upper = np.where(np.arange(steps) > rng.integers(5, 20), rng.uniform(0.0, 40.0), 200.0)
    raw_lower = np.minimum(rng.uniform(0.0, 100.0), raw_upper)
    start = (10.0, 150.0)
    bounds = forces.solve(start, raw_lower, raw_upper)
    assert bounds is not None
    assert forces.second.asked == 0
    lower, upper = bounds
    found = np.concatenate([upper, lower])
    assert _check(forces.problem(start, raw_lower, raw_upper), found) > 0

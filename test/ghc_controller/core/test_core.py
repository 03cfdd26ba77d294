"""The compiled core against dense algebra, and what its answers do not depend on."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from random_problems import random_problem, strict_alpha

from ghc_controller.core import Cascade, Mixture, NullSpace, level_optimum
from ghc_controller.formulations import (
    ControlProblem,
    ForceExpansion,
    Formulation,
    Solution,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.qp import make_solver
from ghc_controller.types import Array, Bounds

SIZES = [3, 2, 3, 17]
TORQUE_SHARES = (None, 0.35)
_EFFORT: tuple[Any, ...] = (True, 200, 2000)  # bounds as well, pivots of a level and of a step


def _dense_null_space(rows: Array, e: float) -> Array:
    """P = I - S^T (S S^T + e^2 I)^-1 S with e in proportion to rows longer than 1."""
    damping = e**2 * np.maximum(1.0, (rows**2).sum(axis=1))
    inner = np.linalg.solve(rows @ rows.T + np.diag(damping), rows)
    return np.eye(rows.shape[1]) - rows.T @ inner


def test_null_space_and_optimum_are_the_dense_ones() -> None:
    """e from 1e-2 down to the default, rows of any length. Seed 0."""
    rng = np.random.default_rng(0)
    for e in (1e-2, 1e-3, 3e-5):
        above, J = rng.normal(size=(6, 11)), rng.normal(size=(4, 11))
        b, y, w = rng.normal(size=4), rng.normal(size=11), 1e-2
        space = NullSpace(11, 6)
        space.append(above[:4], e)
        space.append(above[4:], e)
        P = _dense_null_space(above, e)
        assert np.abs(space.projector() - P).max() < 1e-8
        found, A, damping = level_optimum(J, b, y, space, w)
        assert np.abs(A - J @ P).max() < 1e-7
        wanted = y + P @ A.T @ np.linalg.solve(A @ A.T + damping * np.eye(4), b - J @ y)
        assert np.abs(found - wanted).max() < 1e-7


def _posture(problem: ControlProblem, order: Array) -> ControlProblem:
    """The last task asks for every acceleration, its rows in this order."""
    n = len(order)
    jacobian, target = problem.jacobian.copy(), problem.target.copy()
    jacobian[-n:] = np.eye(n)[order]
    target[-n:] = target[-n:][order]
    return replace(problem, jacobian=jacobian, target=target)


@pytest.mark.parametrize("share", TORQUE_SHARES)
def test_a_posture_is_answered_alike_in_any_order_of_its_rows(share: float | None) -> None:
    """J = I goes by the rows of the null space, a permuted one by its own. Seed 1."""
    rng = np.random.default_rng(1)
    identity = np.arange(17)
    for _ in range(20):
        problem = random_problem(rng, 17, SIZES, strict_alpha(4), share)
        shuffled = rng.permutation(17)
        wanted = make_formulation("cascade").solve(_posture(problem, shuffled))
        found = make_formulation("cascade").solve(_posture(problem, identity))
        assert found.status is wanted.status is SolutionStatus.SOLVED
        assert found.qp_solved == (share is not None)
        size = np.abs(wanted.torque).max()
        assert (
            np.abs(found.torque - wanted.torque).max() < (1e-10 if share is None else 1e-8) * size
        )


def _misses(problem: ControlProblem, answer: Solution) -> Array:
    """(k,) |J_l x - b_l|."""
    left = problem.jacobian @ answer.acceleration - problem.target
    return np.array(
        [
            np.linalg.norm(left[a:b])
            for a, b in zip(problem.starts, problem.starts[1:], strict=False)
        ]
    )


def _without_core() -> Formulation:
    solver = make_solver("daqp")
    solver.lets_core_solve = False
    return make_formulation("cascade", solver=solver)


@pytest.mark.parametrize("contacts", [0, 4])
def test_bounded_levels_are_those_of_the_other_solvers(contacts: int) -> None:
    """Torques to 1e-6 of the largest, or every level as well met to 1e-6. Seed 2."""
    rng = np.random.default_rng(2)
    solved = 0
    for _ in range(30):
        share = 4.0 if contacts else 0.35
        problem = random_problem(rng, 20, [3, 2, 20], strict_alpha(3), share, contacts)
        found = make_formulation("cascade").solve(problem)
        wanted = _without_core().solve(problem)
        assert found.status is wanted.status
        if found.status is not SolutionStatus.SOLVED:
            continue
        solved += 1
        apart = np.abs(found.torque - wanted.torque).max() / np.abs(wanted.torque).max()
        missed = np.abs(_misses(problem, found) - _misses(problem, wanted)).max()
        assert apart < 1e-6 or missed < 1e-6
    assert solved > 5


def test_an_answer_does_not_depend_on_those_before() -> None:
    """The active set of another problem as the start: the same torques to the last bit. Seed 3."""
    rng = np.random.default_rng(3)
    used = make_formulation("cascade")
    for _ in range(30):
        problem = random_problem(rng, 17, SIZES, strict_alpha(4), 0.4)
        fresh = make_formulation("cascade").solve(problem)
        assert fresh.status is SolutionStatus.SOLVED
        for _ in range(2):
            assert np.array_equal(used.solve(problem).torque, fresh.torque)


def test_a_start_from_the_right_active_set_takes_fewer_pivots() -> None:
    """The same problem again costs one pivot a level; after a reset as many as at first."""
    problem = random_problem(np.random.default_rng(4), 17, SIZES, strict_alpha(4), 0.35)
    formulation = make_formulation("cascade")
    first, again = formulation.solve(problem), formulation.solve(problem)
    assert again.iterations <= len(SIZES) < first.iterations
    formulation.reset()
    assert formulation.solve(problem).iterations == first.iterations


def test_the_core_leaves_the_rest_at_a_cap() -> None:
    """Levels with an answer before the pivots are spent; none is worse for it. Seed 5."""
    problem = random_problem(np.random.default_rng(5), 17, SIZES, strict_alpha(4), 0.35)
    ends = np.cumsum(SIZES).tolist()

    def tried(bounded: bool, cap: int) -> tuple[int, int]:
        core = Mixture(1e-2, 3e-5, 0.0)
        order = Cascade(range(sum(SIZES)), ends)
        effort: tuple[Any, ...] = (bounded, 200, cap)
        core.solve((order,), (1.0,), *_arrays(problem), *effort)
        return core.answer(0, bounded, 200, cap)[:2]

    answered, whole = tried(True, 2000)
    assert answered == len(SIZES)
    levels = []
    for cap in range(whole + 1):
        answered, pivots = tried(True, cap)
        levels.append(answered)
        assert pivots <= cap
    assert levels == sorted(levels)
    assert levels[0] == 0
    assert levels[-1] == len(SIZES)
    assert tried(False, 2000)[0] == 0


def _arrays(problem: ControlProblem) -> tuple[Any, ...]:
    """What `Mixture.solve` takes of a problem, up to the effort."""
    boxes = (problem.acceleration, problem.torque, problem.torque_limit)
    return (
        problem.jacobian,
        problem.target,
        problem.mass_matrix,
        problem.bias,
        problem.velocity,
        *(bound for box in boxes for bound in (box.lower, box.upper)),
        problem.rows,
        problem.contacts,
        problem.unactuated,
    )


def test_sizes_that_do_not_fit_are_rejected() -> None:
    """Array by array, of a problem with contacts and general rows; a good one is then solved."""
    rng = np.random.default_rng(6)
    problem = random_problem(rng, 20, [3, 2], strict_alpha(2), contacts=4)
    general = (np.zeros((2, 20)), -np.ones(2), np.ones(2))
    arrays = [*_arrays(replace(problem, rows=None))]
    arrays[11] = general
    core, order = Mixture(1e-2, 3e-5, 0.0), Cascade(range(5), [3, 5])

    def solve(given: list[Any], orders: tuple[Cascade, ...] = (order,)) -> int:
        return core.solve(orders, (1.0,), *given, *_EFFORT)[0]

    contacts = tuple(arrays[12])[:8]
    for place, part in [(i, None) for i in range(11)] + [
        (row, k) for row, parts in ((11, 3), (12, 8)) for k in range(parts)
    ]:
        given = [*arrays]
        if part is None:
            given[place] = np.zeros(np.add(np.shape(given[place]), 1))
        else:
            whole = [*(general if place == 11 else contacts)]
            whole[part] = np.zeros(np.add(np.shape(whole[part]), 1))
            given[place] = tuple(whole)
        with pytest.raises(ValueError, match="expected"):
            solve(given)
        with pytest.raises(IndexError, match="expected"):
            core.answer(0, True, 200, 200)
    for given in ([*arrays[:11], general[:2], *arrays[12:]], [arrays[1], *arrays[1:]]):
        with pytest.raises(ValueError, match="expected"):
            solve(given)
    with pytest.raises(ValueError, match="every row of the order"):
        solve(arrays, (Cascade(range(6), [3, 6]),))
    for orders, shares in (((), ()), ((order,), ())):
        with pytest.raises(ValueError, match="as many shares"):
            core.solve(orders, shares, *arrays, *_EFFORT)
    assert problem.contacts is not None
    cost = ForceExpansion(problem.contacts.force_center, problem.contacts.force_factor)
    pair = (cost.center, cost.factor)
    wrong = ((cost.center[1:], cost.factor), (cost.center, cost.factor[1:]), (cost.center,))
    for costs in (*((one,) for one in wrong), (pair, pair)):
        given = [*arrays, *_EFFORT, None, 0.0, costs]
        with pytest.raises(ValueError, match="expected"):
            core.solve((order,), (1.0,), *given)
        with pytest.raises(IndexError, match="expected"):
            core.forces()
    assert core.solve((order,), (1.0,), *[*arrays, *_EFFORT, None, 0.0, (pair,)])[0] == 1
    assert solve(arrays) == 1
    assert len(core.forces()) == 1
    space = NullSpace(7, 3)
    with pytest.raises(ValueError, match="capacity"):
        space.append(np.zeros((4, 7)), 1e-3)
    for ends in ([], [3], [3, 6], [5, 3], [-1, 5], [6, 5]):
        with pytest.raises(ValueError, match="ascending up to the last row"):
            Cascade(range(5), ends)
    J = np.zeros((5, 7))
    for target, y in ((np.zeros(4), np.zeros(7)), (np.zeros(5), np.zeros(6))):
        with pytest.raises(ValueError, match="expected"):
            level_optimum(J, target, y, space, 1e-2)
    with pytest.raises(ValueError, match="expected"):
        level_optimum(J, np.zeros(5), np.zeros(7), NullSpace(6, 3), 1e-2)
    for sizes in ((-1, 3), (7, -1)):
        with pytest.raises(ValueError, match="at least 0"):
            NullSpace(*sizes)


@pytest.mark.parametrize("kind", ["acceleration", "torque"])
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_a_bound_that_is_no_number_is_met_by_no_answer(kind: str, side: str) -> None:
    """Whichever row it bounds: no level has an answer. Seed 7."""
    rng = np.random.default_rng(7)
    for row in range(7):
        problem = random_problem(rng, 7, [3, 2, 7], strict_alpha(3), 0.35)
        bounds = getattr(problem, kind)
        changed = {name: getattr(bounds, name).copy() for name in ("lower", "upper")}
        changed[side][row] = np.nan
        given = replace(problem, **{kind: Bounds(**changed)})
        core, order = Mixture(1e-2, 3e-5, 20.0), Cascade(range(12), [3, 5, 12])
        for one, levels in ((problem, 3), (given, 0), (problem, 3)):
            one = replace(one, torque_limit=one.torque)
            core.solve((order,), (1.0,), *_arrays(one), *_EFFORT)
            assert core.answer(0, True, 200, 2000)[0] == levels


@pytest.mark.parametrize("n", [1, 7, 47, 48, 63, 130])
@pytest.mark.parametrize("share", TORQUE_SHARES)
def test_a_posture_may_come_first_on_a_robot_of_any_size(n: int, share: float | None) -> None:
    """Alone, and above another task; no rows above it. As with permuted rows. Seed 12."""
    rng = np.random.default_rng(12)
    shuffled = rng.permutation(n)
    for above in ([], [min(n, 3)]):
        sizes = [*above, n]
        order = strict_alpha(len(sizes))
        problem = random_problem(rng, n, sizes, order.T if above else order, share)
        wanted = make_formulation("cascade").solve(_posture(problem, shuffled))
        found = make_formulation("cascade").solve(_posture(problem, np.arange(n)))
        assert found.status is wanted.status is SolutionStatus.SOLVED
        scale = 1.0 + np.abs(wanted.acceleration).max()
        assert np.abs(found.acceleration - wanted.acceleration).max() <= 1e-6 * scale

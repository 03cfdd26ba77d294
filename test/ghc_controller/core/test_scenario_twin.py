"""Ticks of the core at recorded states of every scenario against the dense twins.

The files are written by `python -m benchmarks.ticks.record`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from reference.bounded_twin import bounded_answer
from reference.smooth_twin import apart, rows_of_levels, twin_answer, unbounded

from benchmarks.ticks.tick_file import STATES, load
from ghc_controller.formulations import (
    ControlProblem,
    ForceExpansion,
    Solution,
    SolutionStatus,
    make_formulation,
)
from ghc_controller.types import Bounds
from ghc_sim_bridge.scenario.scenario import scenario_names

FILES = sorted(STATES.glob("*.npz"))
_REACHED = (0.8, 0.4)  # [-] of the torque beside what holds the robot: bounds that are met
_APART = 5.0  # [N] standard deviation of the centers of costs on forces
_PUSH = 2.0  # [m/s^2], [rad/s^2] standard deviation of what is added to targets
# Torque: without bounds relative, with them in Nm or from the optimum of every level.
_FREE, _BOUNDED = 1e-10, 1e-6

by_file = pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])


@cache
def _problems(path: Path) -> list[ControlProblem]:
    return load(path)


def _solve(problem: ControlProblem) -> Solution:
    return make_formulation("cascade").solve(problem)


def test_every_scenario_is_recorded() -> None:
    """With ticks in a ramp and ticks in contact among them."""
    assert [path.stem for path in FILES] == sorted(scenario_names())
    problems = [problem for path in FILES for problem in _problems(path)]
    assert sum(len(problem.priorities.candidates) > 1 for problem in problems) >= 12
    assert sum(problem.contacts is not None for problem in problems) >= 12


@by_file
def test_without_bounds_the_core_is_the_twin(path: Path) -> None:
    for problem in map(unbounded, _problems(path)):
        found = _solve(replace(problem, rows=None))
        assert found.status is SolutionStatus.SOLVED
        assert not found.qp_solved
        *_, torque = twin_answer(problem)
        assert apart(found.torque, torque) < _FREE


@by_file
def test_at_its_bounds_the_core_is_the_twin(path: Path) -> None:
    """As recorded, and pushed against torque limits that are reached. Seed 7."""
    for problem in _problems(path):
        assert _is_twin(problem) is not None
    rng = np.random.default_rng(7)
    qps = [
        _is_twin(_limited(problem, rng, share))
        for problem in _problems(path)
        for share in _REACHED
    ]
    assert sum(each is not None and each > 0 for each in qps) >= len(qps) / 2


def test_with_a_cost_on_forces_for_each_order_the_core_is_the_twin() -> None:
    """Ramps in contact, pushed against torque limits as well; centers 5 N apart. Seed 9."""
    rng = np.random.default_rng(9)
    tried = solved = 0
    for problem in (one for path in FILES for one in _problems(path)):
        contacts = problem.contacts
        if contacts is None or len(problem.priorities.candidates) == 1:
            continue
        center, factor = contacts.force_center, contacts.force_factor
        costs = {
            one.alpha.tobytes(): ForceExpansion(
                center + rng.normal(scale=_APART, size=len(center)),
                factor * rng.uniform(0.7, 1.4),
            )
            for one in problem.priorities.candidates
        }
        own = replace(problem, contacts=contacts._replace(of_candidates=costs))
        for one in (own, *(_limited(own, rng, share) for share in _REACHED)):
            tried, solved = tried + 1, solved + (_is_twin(one) is not None)
    assert tried >= 12
    assert solved >= tried / 2


def _is_twin(problem: ControlProblem) -> int | None:
    """Assert that core and twin agree; QPs of the twin, None where the bounds conflict."""
    found = _solve(replace(problem, torque=problem.torque_limit))
    if found.status is not SolutionStatus.SOLVED:
        return None
    answer = bounded_answer(problem)
    if np.abs(found.torque - answer.torque).max() > _BOUNDED:
        for candidate in problem.priorities.candidates:
            for rows in rows_of_levels(problem, candidate.alpha):
                J, b = problem.jacobian[rows], problem.target[rows]
                misses = [float(np.linalg.norm(J @ x - b)) for x in (found.acceleration, answer.x)]
                assert abs(misses[0] - misses[1]) < _BOUNDED
    return answer.qps


def _limited(problem: ControlProblem, rng: np.random.Generator, share: float) -> ControlProblem:
    """With targets that ask for more, and torque limits at a share of what they take."""
    push = _PUSH * rng.normal(size=len(problem.target))
    pushed = replace(problem, target=problem.target + push)
    weight = problem.bias[problem.unactuated :]
    size = np.abs(weight) + share * np.abs(_solve(unbounded(pushed)).torque - weight)
    size = np.minimum(size, problem.torque_limit.upper)
    limit = Bounds(-size, size)
    return replace(pushed, torque_limit=limit, torque=limit)

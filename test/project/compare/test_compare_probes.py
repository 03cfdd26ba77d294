"""Probes see what they should: levels that are taken from, and ramps that switch.

Seed 0: problems of 7 joints with three tasks, bounds that cut the answer of `hqp` in half.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import ghc_controller as ghc
from benchmarks.compare.runs.closed_loop import Change
from benchmarks.compare.runs.probes import ramp_step, strictness
from benchmarks.problems.order_problems import bounded, order, well_scaled_problem
from ghc_controller.formulations import make_formulation
from ghc_controller.hierarchy.priorities import Priorities

SIZES, JOINTS, COUNT = (3, 2, 7), 7, 10
STRICT = order([0], [1], [2], tasks=3)
SWAPPED = order([1], [0], [2], tasks=3)
SETTINGS = ghc.FormulationSettings(velocity_damping=0.0)


@cache
def problems(tight: bool) -> list[ghc.ControlProblem]:
    rng, hqp = np.random.default_rng(0), make_formulation("hqp", SETTINGS)
    found = []
    for _ in range(COUNT):
        problem = well_scaled_problem(rng, SIZES, JOINTS, Priorities.of(STRICT))
        half = bounded(problem, hqp.solve(problem).acceleration, 0.5)
        found.append(half if tight else problem)
    return found


@pytest.mark.parametrize("formulation", ["cascade", "hqp", "rhp_hqp"])
def test_hierarchical_qps_are_strict_with_and_without_bounds(formulation: str) -> None:
    tight = strictness(formulation, SETTINGS, problems(True))
    assert tight.first is not None and tight.first < 1e-6
    assert tight.any_level is not None and tight.any_level < 1e-5
    free = strictness(formulation, SETTINGS, problems(False))
    assert free.free is not None and free.free < 1e-6
    assert free.first is None


def test_one_qp_gives_up_a_part_of_its_first_level_at_bounds() -> None:
    tight = strictness("weighted", SETTINGS, problems(True))
    assert tight.first is not None and tight.first > 1e-3
    free = strictness("ghc", SETTINGS, problems(False))
    assert free.free is not None and free.free < 1e-6


def test_a_blend_is_even_and_a_switch_is_a_jump() -> None:
    """`hqp` reads a tie at the middle, so that its jump has two steps."""
    changes = [Change(problem, STRICT, SWAPPED) for problem in problems(False)[:3]]
    even, switch = (ramp_step(name, SETTINGS, changes) for name in ("cascade", "hqp"))
    assert even is not None and switch is not None
    assert abs(even - 0.01) < 1e-4
    assert switch > 0.5


def test_a_ramp_between_equal_orders_has_no_shape() -> None:
    assert ramp_step("cascade", SETTINGS, [Change(problems(False)[0], STRICT, STRICT)]) is None
    assert ramp_step("cascade", SETTINGS, []) is None

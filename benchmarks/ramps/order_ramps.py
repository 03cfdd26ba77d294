"""Smoothness of a formulation during ramps between random orders: swaps and removals."""

from __future__ import annotations

from typing import Any

import numpy as np

import ghc_controller as ghc
from benchmarks.problems.order_problems import (
    answer_on_ramp,
    bounded,
    identical_tasks,
    jump,
    largest_step,
    order,
    well_scaled_problem,
)
from ghc_controller.formulations import make_formulation
from ghc_controller.hierarchy import Priorities

SWAP = order([0], [1], [2], tasks=3), order([1], [0], [2], tasks=3)
REMOVAL = order([0], [1], [2], tasks=3), order([0], [2], tasks=3)
SHARES = tuple(float(s) for s in np.linspace(0.0, 1.0, 21))
SEED = 0
_SIZES = (3, 3, 7)  # the last one is a posture of all seven joints
_STRICT = (((3, 2, 7), 7), ((1, 3, 3, 1, 17), 17))


def ramps(formulation: str, settings: ghc.FormulationSettings, count: int) -> dict[str, Any]:
    """Medians over `count` problems: jumps at the ends, largest of 100 steps, and the removal.

    `removed` is the way from the first to the last answer at SHARES, as a share of the whole.
    """
    rng = np.random.default_rng(SEED)
    swaps = [
        answer_on_ramp(formulation, settings, identical_tasks(rng), SWAP) for _ in range(count)
    ]
    removals = [
        answer_on_ramp(
            formulation,
            settings,
            well_scaled_problem(rng, _SIZES, _SIZES[-1], Priorities.of(REMOVAL[0])),
            REMOVAL,
        )
        for _ in range(count)
    ]
    ways = []
    for x in removals:
        first, last = x(0.0), x(1.0)
        whole = float(np.linalg.norm(last - first))
        ways.append([float(np.linalg.norm(x(s) - first)) / whole for s in SHARES])
    return {
        "swap_jump": float(np.median([jump(x) for x in swaps])),
        "swap_step": float(np.median([largest_step(x) for x in swaps])),
        "removal_step": float(np.median([largest_step(x) for x in removals])),
        "removed": [float(value) for value in np.median(ways, axis=0)],
    }


def difference_to_hqp(formulation: str, settings: ghc.FormulationSettings, count: int) -> float:
    """Largest relative difference of accelerations at strict orders, bounds off and on."""
    rng = np.random.default_rng(SEED)
    one, other = (make_formulation(name, settings) for name in (formulation, "hqp"))
    largest = 0.0
    for sizes, n in _STRICT:
        k = len(sizes)
        for _ in range(count):
            depth = [*rng.permutation(k - 1), k - 1]
            alpha = order(*[[int(task)] for task in depth], tasks=k)
            problem = well_scaled_problem(rng, sizes, n, Priorities.of(alpha))
            tight = bounded(problem, other.solve(problem).acceleration, 0.5)
            for case in (problem, tight):
                x, expected = (each.solve(case).acceleration for each in (one, other))
                apart = np.linalg.norm(x - expected) / np.linalg.norm(expected)
                largest = max(largest, float(apart))
    return largest

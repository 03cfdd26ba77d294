"""Seeded pairs of position targets that an arm can meet alone but not together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

import ghc_controller as ghc
from ghc_controller.types import Array

APART = 0.2  # [m] least norm of both errors together, at the best posture
_STARTS = 6  # of the search for that posture
_INSIDE = 0.05  # [-] of the range of a joint that postures keep away from its ends
_RANGE = 3.0  # [rad] postures are drawn within it where a joint may turn further


class Pair(NamedTuple):
    """Targets in the world, and how far they are from being met together."""

    upper: Array  # (3,) [m] of the first task
    lower: Array  # (3,) [m] of the second task
    apart: float  # [m]


def conflicting_pairs(robot: ghc.Robot, count: int, seed: int) -> list[Pair]:
    """Targets of the robot's first two tasks: each is where its frame is in a random posture."""
    rng = np.random.default_rng(seed)
    model = robot.model
    low = np.maximum(model.position_lower, -_RANGE)
    high = np.minimum(model.position_upper, _RANGE)
    low, high = low + _INSIDE * (high - low), high - _INSIDE * (high - low)
    pairs: list[Pair] = []
    while len(pairs) < count:
        upper, lower = (
            _places(robot, rng.uniform(low, high))[rows] for rows in (slice(0, 3), slice(3, 6))
        )
        both = np.concatenate([upper, lower])
        starts = rng.uniform(low, high, (_STARTS, len(low)))
        apart = min(_distance(robot, both, start, low, high) for start in starts)
        if apart >= APART:
            pairs.append(Pair(upper, lower, apart))
    return pairs


def _places(robot: ghc.Robot, q: Array) -> Array:
    """(6,) [m] positions of the first two tasks' frames."""
    robot.model.update(q, np.zeros(robot.model.nv))
    return np.concatenate([task.current(robot.model) for task in robot.tasks[:2]])


def _distance(robot: ghc.Robot, both: Array, start: Array, low: Array, high: Array) -> float:
    found = least_squares(lambda q: _places(robot, q) - both, start, bounds=(low, high))
    return float(np.linalg.norm(found.fun))

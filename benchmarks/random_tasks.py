"""Random targets and priorities of the studies; the order of the draws belongs to the seeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import ghc_controller as ghc
from ghc_controller.numerics.rotation import quaternion_product, rotation_exp
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class Reach:
    """How far targets may be from where the tasks are."""

    angle: float = 1.0  # [rad] of an orientation
    position: float = 0.3  # [m]
    posture: float = 0.6  # [rad]
    pose: float = 0.0  # [m] of the position of a pose; 0 = it stays


def random_references(
    robot: ghc.Robot, rng: np.random.Generator, reach: Reach
) -> list[ghc.ReferenceTrajectory]:
    """A static target at rest for every task, about the pose of the model's last update."""
    found = []
    for task in robot.tasks:
        target = _moved(np.array(task.current(robot.model)), rng, reach)
        found.append(ghc.ReferenceTrajectory.static(task, task.static_target(target)))
    return found


def _moved(current: Array, rng: np.random.Generator, reach: Reach) -> Array:
    size = len(current)
    if size in (4, 7):  # quaternion x, y, z, w, at the end
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        turn = rotation_exp(axis * rng.uniform(0.0, reach.angle))
        current[-4:] = quaternion_product(current[-4:].copy(), turn)
        if size == 7 and reach.pose > 0.0:
            current[:3] += rng.uniform(-reach.pose, reach.pose, 3)
        return current
    largest = reach.position if size <= 3 else reach.posture
    return current + rng.uniform(-largest, largest, size)


def strict_matrix(order: Sequence[int], count: int) -> Array:
    """(k, k) priority matrix of a strict order, highest first; tasks left out are removed."""
    place = {task: depth for depth, task in enumerate(order)}
    alpha = np.zeros((count, count))
    for i in range(count):
        for j in range(count):
            if i not in place or (j in place and place[j] < place[i]):
                alpha[i, j] = 1.0
    return alpha


def random_matrix(rng: np.random.Generator, count: int) -> tuple[Array, str]:
    """(k, k) matrix and its kind: half strict orders of some tasks, cycles, arbitrary values."""
    share = rng.random()
    if share < 0.5:
        kept = int(rng.integers(1, count + 1))
        return strict_matrix(list(rng.permutation(count)[:kept]), count), "order"
    if share < 0.75:
        alpha = strict_matrix(list(rng.permutation(count)), count)
        a, b, c = rng.permutation(count)[:3]
        for above, below in ((a, b), (b, c), (c, a)):
            alpha[below, above], alpha[above, below] = 1.0, 0.0
        return alpha, "cycle"
    alpha = rng.random((count, count))
    np.fill_diagonal(alpha, 0.0)
    return alpha, "values"

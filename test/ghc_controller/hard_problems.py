"""Random control problems that are badly scaled, rank-deficient, duplicated or nearly singular."""

from __future__ import annotations

import numpy as np
from random_problems import random_alpha, strict_alpha

from ghc_controller.formulations import ControlProblem
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array, Bounds


def hard_problem(rng: np.random.Generator) -> tuple[ControlProblem, bool]:
    """A problem with a fixed base, and whether x = 0 meets all its bounds.

    7 to 32 joints, 2 to 6 tasks; a third have a mass matrix scaled by 1e-4 to 1e4, a fifth boxes
    on the accelerations that exclude x = 0.
    """
    n, k = int(rng.choice([7, 12, 17, 32])), int(rng.integers(2, 7))
    tasks: list[Array] = []
    for _ in range(k):
        tasks.append(_hard_rows(rng, n, tasks))
    jacobian = np.vstack(tasks)
    target = rng.normal(size=jacobian.shape[0]) * 10.0 ** rng.uniform(-1, 1)
    starts = np.concatenate([[0], np.cumsum([len(rows) for rows in tasks])]).astype(np.int64)
    alpha = strict_alpha(k) if rng.random() < 0.5 else random_alpha(rng, k)
    root = rng.normal(size=(n, n))
    mass = root @ root.T / n + 0.1 * np.eye(n)
    if rng.random() < 1 / 3:
        scale = 10.0 ** rng.uniform(-2, 2, n)
        mass = scale[:, None] * mass * scale
    bias, half = 3.0 * rng.normal(size=n), 10.0 ** rng.uniform(-1, 1)
    box = 10.0 ** rng.uniform(-0.5, 1.5)
    lower, upper = -box * rng.uniform(0.2, 1.0, n), box * rng.uniform(0.2, 1.0, n)
    stands = bool(rng.random() < 0.8)
    if not stands:
        lower, upper = lower + 2.0 * box, upper + 2.5 * box
    torque = Bounds(bias - half, bias + half)
    priorities, still, limits = Priorities.of(alpha), np.zeros(n), Bounds(lower, upper)
    return ControlProblem(
        jacobian, target, starts, priorities, mass, bias, still, limits, torque, torque
    ), stands


def _hard_rows(rng: np.random.Generator, n: int, before: list[Array]) -> Array:
    """Rows (m, n) of one task."""
    if rng.random() < 0.15:
        return np.eye(n)
    rows = rng.normal(size=(int(rng.integers(2, 7)), n))
    kind = int(rng.integers(6))
    if kind == 0:  # a row twice
        rows[-1] = rows[0] * rng.normal()
    elif kind == 1 and before:  # the task of before once more, with another target
        rows = before[int(rng.integers(len(before)))].copy()
    elif kind == 2 and before:  # depends on the task before in one row
        rows[0] = before[-1][0] + rng.normal() * before[-1][-1]
    elif kind == 3:  # units far apart
        rows *= 10.0 ** rng.uniform(-3, 3, size=(rows.shape[0], 1))
    elif kind == 4:  # nearly singular
        left, sigma, right = np.linalg.svd(rows, full_matrices=False)
        sigma[-1] *= 10.0 ** rng.uniform(-8, -1)
        rows = (left * sigma) @ right
    elif kind == 5:  # a row that asks for nothing
        rows[0] = 0.0
    return rows


def violation(problem: ControlProblem, acceleration: Array, torque: Array, soft: bool) -> float:
    """Largest violation of torque box and M x + h = tau [Nm] and, if soft, of the box on x."""
    box, limits = problem.acceleration, problem.torque
    needed = problem.mass_matrix @ acceleration + problem.bias
    excess = [limits.lower - torque, torque - limits.upper, np.abs(needed - torque)]
    excess += [limits.lower - needed, needed - limits.upper]
    if soft:
        excess += [box.lower - acceleration, acceleration - box.upper]
    return float(np.max(excess))

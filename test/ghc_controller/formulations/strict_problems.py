"""Random levels of strict orders, and the lexicographic optimum that they are compared with."""

from __future__ import annotations

import numpy as np

from ghc_controller.formulations import ControlProblem
from ghc_controller.formulations.baselines.strict_law import Level
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array, Bounds

# Joints, rows by level, and whether levels share directions with those above.
CASES = [
    (10, [2, 3, 2], False),
    (10, [2, 3, 2], True),
    (28, [4, 2, 3, 3], True),
    (8, [3, 3, 3], True),
    (7, [3, 3, 7], False),
    (7, [3, 3, 7], True),
]


def random_levels(
    rng: np.random.Generator, n: int, sizes: list[int], conflict: bool
) -> list[Level]:
    """Normal rows and targets; in conflict a row of levels 2 and 3 depends on those above."""
    rows = [rng.normal(size=(m, n)) for m in sizes]
    if conflict:
        rows[1][0] = rows[0].T @ rng.normal(size=sizes[0])
        if len(sizes) > 2:
            rows[2][0] = rows[0].T @ rng.normal(size=sizes[0])
            rows[2][0] += rows[1].T @ rng.normal(size=sizes[1])
    return [Level(J, rng.normal(size=len(J))) for J in rows]


def random_inertia(rng: np.random.Generator, n: int) -> Array:
    """(n, n) symmetric and positive definite."""
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.3 * np.eye(n)


def strict_problem(order: list[Level], mass: Array, bias: Array) -> ControlProblem:
    """The same levels, one task each, at rest and without bounds that count."""
    n, k = len(bias), len(order)
    wide = Bounds(np.full(n, -1e9), np.full(n, 1e9))
    return ControlProblem(
        np.vstack([level.jacobian for level in order]),
        np.concatenate([level.target for level in order]),
        np.concatenate([[0], np.cumsum([len(level.target) for level in order])]),
        Priorities.of(np.tril(np.ones((k, k)), -1)),
        mass,
        bias,
        np.zeros(n),
        wide,
        wide,
        wide,
    )


def null_basis(rows: Array, tolerance: float = 1e-8) -> Array:
    """(n, d) orthonormal columns of the null space of rows (m, n)."""
    if len(rows) == 0:
        return np.eye(rows.shape[1])
    _, sigma, right = np.linalg.svd(rows, full_matrices=True)
    rank = int(np.sum(sigma > tolerance * max(float(sigma[0]), 1e-300)))
    return right[rank:].T


def lexicographic(order: list[Level], tolerance: float = 1e-8) -> Array:
    """Each level by least squares in what those above leave; least norm of what is left, (n,)."""
    n = order[0].jacobian.shape[1]
    x, null = np.zeros(n), np.eye(n)
    for jacobian, target in order:
        local, least = jacobian @ null, tolerance * np.linalg.norm(jacobian, 2)
        _, sigma, right = np.linalg.svd(local, full_matrices=True)
        rank = int(np.sum(sigma > least))
        if rank:
            inverse = np.linalg.pinv(local, rcond=least / sigma[0])
            x = x + null @ (inverse @ (target - jacobian @ x))
        null = null @ right[rank:].T
    return x


def difference(a: Array, b: Array) -> float:
    """Largest difference, relative to the largest entry of b where that exceeds 1."""
    return float(np.abs(a - b).max() / max(1.0, np.abs(b).max()))

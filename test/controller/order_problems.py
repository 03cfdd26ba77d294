"""Random problems whose priorities mix orders, as in the comparison of RHP-HQP with others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ghc_controller.formulations import ControlProblem
from ghc_controller.hierarchy import Candidate, Priorities, matrix_from_hierarchy
from ghc_controller.types import Array, Bounds

_FREE = 1e6  # [Nm], [rad/s^2] a bound that is never met


def order(*levels: Sequence[int], tasks: int) -> Array:
    """(k, k) matrix of an order by levels, highest first; tasks left out are removed."""
    names = [f"t{i}" for i in range(tasks)]
    text = " > ".join(" = ".join(names[i] for i in level) for level in levels)
    return np.array(matrix_from_hierarchy(names, text).alpha)


def mixed(*parts: tuple[Array, float]) -> Priorities:
    """Mixture of (alpha, share); shares of zero are left out, as a ramp does."""
    return Priorities.mixed(Candidate(alpha, share) for alpha, share in parts if share > 0.0)


def well_scaled_problem(
    rng: np.random.Generator, sizes: Sequence[int], n: int, priorities: Priorities
) -> ControlProblem:
    """Tasks with rows of length about 1, a posture of all joints where a size is n; no bounds."""
    jacobian = [
        np.eye(n) if size == n else rng.normal(size=(size, n)) / np.sqrt(n) for size in sizes
    ]
    target = np.concatenate([rng.normal(size=size) for size in sizes])
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    root, bias = rng.normal(size=(n, n)), rng.normal(size=n)
    free = np.full(n, _FREE)
    torque = Bounds(bias - free, bias + free)
    return ControlProblem(
        np.vstack(jacobian),
        target,
        starts,
        priorities,
        root @ root.T / n + 0.3 * np.eye(n),
        bias,
        np.zeros(n),
        Bounds(-free, free),
        torque,
        torque,
    )


def bounded(problem: ControlProblem, x: Array, share: float) -> ControlProblem:
    """The problem with torques around the bias within a share of the largest one of x (n,)."""
    half = share * np.abs(problem.mass_matrix @ x).max() * np.ones(len(x))
    torque = Bounds(problem.bias - half, problem.bias + half)
    return replace(problem, torque=torque, torque_limit=torque)

"""Random control problems shared by the tests of the formulations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ghc_controller.formulations import ContactRows, ControlProblem, ForceExpansion
from ghc_controller.hierarchy import Priorities
from ghc_controller.types import Array, Bounds

# Rows on (f_x, f_y, f_z) that are at most 0: friction coefficient 0.7, pushing only.
_PYRAMID = np.array(
    [[1, 0, -0.7], [-1, 0, -0.7], [0, 1, -0.7], [0, -1, -0.7], [0, 0, -1.0]], dtype=np.float64
)


def strict_alpha(k: int) -> Array:
    """(k, k) of 1 > 2 > .. > k."""
    return np.tril(np.ones((k, k)), -1)


def random_alpha(rng: np.random.Generator, k: int) -> Array:
    """(k, k) with entries 0, 1, ties and anything between; task 0 unrestricted."""
    alpha = rng.choice([0.0, 0.3, 0.3, 1.0, -1.0], size=(k, k))
    alpha = np.where(alpha < 0.0, rng.uniform(size=(k, k)), alpha)
    np.fill_diagonal(alpha, 0.0)
    alpha[0] = 0.0
    return alpha


def random_problem(
    rng: np.random.Generator,
    n: int,
    sizes: list[int],
    alpha: Array,
    torque_share: float | None = None,
    contacts: int = 0,
) -> ControlProblem:
    """A problem whose torque box is `torque_share` of a likely unconstrained torque.

    With `contacts` > 0: six unactuated coordinates and that many point contacts with friction
    pyramids; the torque box is then wide unless a share is given.
    """
    m = sum(sizes)
    jacobian = rng.normal(size=(m, n))
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    target = 5.0 * rng.normal(size=m)
    root = rng.normal(size=(n, n))
    mass = root @ root.T / n + 0.5 * np.eye(n)
    bias = 2.0 * rng.normal(size=n)
    wide = np.full(n, 1e3)
    unactuated = 6 if contacts else 0
    center = bias[unactuated:]
    if torque_share is None:
        half = np.full(n - unactuated, 1e3)
    else:
        likely = np.abs(mass @ np.linalg.lstsq(jacobian, target, rcond=None)[0])[unactuated:]
        half = torque_share * likely + 0.05
    rows = _contact_rows(rng, n, contacts, bias) if contacts else None
    torque = Bounds(center - half, center + half)
    return ControlProblem(
        jacobian,
        target,
        starts,
        Priorities.of(alpha),
        mass,
        bias,
        np.zeros(n),
        Bounds(-wide, wide),
        torque,
        torque,
        contacts=rows,
        unactuated=unactuated,
    )


def own_costs(rng: np.random.Generator, problem: ControlProblem) -> ControlProblem:
    """The problem with another cost on contact forces for each candidate of its mixture."""
    if problem.contacts is None:
        return problem
    c = len(problem.contacts.force_center)
    costs = {
        candidate.alpha.tobytes(): ForceExpansion(
            rng.normal(size=c), (np.eye(c) + 0.3 * rng.normal(size=(c, c))) * 30.0
        )
        for candidate in problem.priorities.candidates
    }
    return replace(problem, contacts=problem.contacts._replace(of_candidates=costs))


def _contact_rows(rng: np.random.Generator, n: int, contacts: int, bias: Array) -> ContactRows:
    """Point contacts under a body: lever arms around it, normals up, friction 0.7.

    The unactuated part of the bias is set so that the contacts can carry it.
    """
    jacobian = rng.normal(size=(3 * contacts, n))
    pyramid = []
    load = np.zeros(6)
    for c in range(contacts):
        arm = rng.normal(size=3)
        jacobian[3 * c : 3 * c + 3, :3] = np.eye(3)
        jacobian[3 * c : 3 * c + 3, 3:6] = -np.array(
            [[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]]
        )
        block = np.zeros((5, 3 * contacts))
        block[:, 3 * c : 3 * c + 3] = _PYRAMID
        pyramid.append(block)
        load += jacobian[3 * c : 3 * c + 3, :6].T @ np.array([0.0, 0.0, 40.0])
    bias[:6] = load
    matrix = np.vstack(pyramid)
    factor = np.eye(3 * contacts) / np.sqrt(1e-3)
    names = tuple(f"cone_{row}" for row in range(matrix.shape[0]))
    return ContactRows(
        jacobian,
        rng.normal(size=3 * contacts),
        jacobian,
        matrix,
        np.full(matrix.shape[0], -np.inf),
        np.zeros(matrix.shape[0]),
        rng.normal(size=3 * contacts),
        factor,
        names,
    )

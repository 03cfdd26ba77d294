"""Random problems whose priorities mix orders, as in the comparison of RHP-HQP with others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

import ghc_controller as ghc
from ghc_controller.formulations import make_formulation
from ghc_controller.hierarchy import Candidate, Priorities
from ghc_controller.types import Array, Bounds

_FREE = 1e6  # [Nm], [rad/s^2] a bound that is never met
_AT_THE_ENDS = 1e-9  # [-] share of the other order: what a step to it adds is a jump

Answer = Callable[[float], Array]  # share of the target -> x (n,)


def order(*levels: Sequence[int], tasks: int) -> Array:
    """(k, k) matrix of an order by levels, highest first; tasks left out are removed."""
    names = [f"t{i}" for i in range(tasks)]
    text = " > ".join(" = ".join(names[i] for i in level) for level in levels)
    return np.array(ghc.matrix_from_hierarchy(names, text).alpha)


def mixed(*parts: tuple[Array, float]) -> Priorities:
    """Mixture of (alpha, share); shares of zero are left out, as a ramp does."""
    return Priorities.mixed(Candidate(alpha, share) for alpha, share in parts if share > 0.0)


def well_scaled_problem(
    rng: np.random.Generator, sizes: Sequence[int], n: int, priorities: Priorities
) -> ghc.ControlProblem:
    """Tasks with rows of length about 1, a posture of all joints where a size is n; no bounds."""
    jacobian = [
        np.eye(n) if size == n else rng.normal(size=(size, n)) / np.sqrt(n) for size in sizes
    ]
    target = np.concatenate([rng.normal(size=size) for size in sizes])
    starts = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    root, bias = rng.normal(size=(n, n)), rng.normal(size=n)
    free = np.full(n, _FREE)
    torque = Bounds(bias - free, bias + free)
    return ghc.ControlProblem(
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


def bounded(problem: ghc.ControlProblem, x: Array, share: float) -> ghc.ControlProblem:
    """The problem with torques around the bias within a share of the largest one of x (n,)."""
    half = share * np.abs(problem.mass_matrix @ x).max() * np.ones(len(x))
    torque = Bounds(problem.bias - half, problem.bias + half)
    return replace(problem, torque=torque, torque_limit=torque)


def identical_tasks(rng: np.random.Generator) -> ghc.ControlProblem:
    """Two tasks with the same Jacobian and different targets above a posture, 7 joints."""
    problem = well_scaled_problem(rng, (3, 3, 7), 7, Priorities.of(np.zeros((3, 3))))
    problem.jacobian[3:6] = problem.jacobian[:3]
    return problem


def answer_on_ramp(
    formulation: str,
    settings: ghc.FormulationSettings,
    problem: ghc.ControlProblem,
    ends: Sequence[Array],
) -> Answer:
    """Accelerations of a problem over the share of the second of two orders (k, k)."""
    solver = make_formulation(formulation, settings)

    def x(s: float) -> Array:
        mixture = mixed((ends[0], 1.0 - s), (ends[1], s))
        return solver.solve(replace(problem, priorities=mixture)).acceleration

    return x


def largest_step(x: Answer, steps: int = 100) -> float:
    """Largest of equal steps of the share, over the whole change; 1 / steps = even."""
    answers = [x(s) for s in np.linspace(0.0, 1.0, steps + 1)]
    sizes = [float(np.linalg.norm(b - a)) for a, b in pairwise(answers)]
    return max(sizes) / float(np.linalg.norm(answers[-1] - answers[0]))


def jump(x: Answer) -> float:
    """What the answer jumps by at both ends together, over the whole change."""
    first, last = x(0.0), x(1.0)
    begin, end = x(_AT_THE_ENDS) - first, x(1.0 - _AT_THE_ENDS) - last
    whole = np.linalg.norm(last - first)
    return float((np.linalg.norm(begin) + np.linalg.norm(end)) / whole)

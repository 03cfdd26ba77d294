"""Solutions of a formulation at fixed states: strictness of its levels, shape of a ramp.

Probes have a formulation of their own, so that they leave the run as it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import ghc_controller as ghc
from benchmarks.compare.runs.closed_loop import Change
from ghc_controller.formulations import SolutionStatus, make_formulation
from ghc_controller.hierarchy import Priorities
from ghc_controller.hierarchy.levels import is_order, levels
from ghc_controller.hierarchy.priorities import Candidate

STEPS = 100  # of a ramp
LEAST_TARGET = 0.1  # [m/s^2], [rad/s^2] length of b below which a loss is measured against it
_LEAST_CHANGE = 1e-3  # [Nm] a ramp that changes less has no shape to speak of


class Strictness(NamedTuple):
    """Largest disturbance of a level by the levels below, (J x - J x_alone) / b.

    x_alone is the answer of the same formulation without the levels below. None without a state.
    """

    first: float | None  # of the first level, at states where a bound is met
    any_level: float | None  # of any level, there
    free: float | None  # of any level, at states where no bound is met


def strictness(
    formulation: str, settings: ghc.FormulationSettings, problems: Iterable[ghc.ControlProblem]
) -> Strictness:
    """Over all levels but the last of each problem whose matrix is an order."""
    solver = make_formulation(formulation, settings)
    first: list[float] = []
    bounded: list[float] = []
    free: list[float] = []
    for problem in problems:
        order = levels(problem.alpha)
        if not is_order(problem.alpha) or len(order) < 2:
            continue
        whole = solver.solve(problem)
        losses, met = [], whole.qp_solved
        for depth in range(1, len(order)):
            alone = solver.solve(_upper(problem, order, depth))
            met = met or alone.qp_solved
            answered = SolutionStatus.FAILED not in (whole.status, alone.status)
            losses.append(_loss(problem, order[depth - 1], whole, alone) if answered else math.nan)
        if np.isnan(losses).any():
            continue  # no answer, no loss: counted as a step that is not SOLVED
        if met:
            first.append(losses[0])
        (bounded if met else free).append(max(losses))
    return Strictness(*(max(values, default=None) for values in (first, bounded, free)))


def _upper(problem: ghc.ControlProblem, order: list[list[int]], depth: int) -> ghc.ControlProblem:
    """The problem with the first `depth` levels alone.

    In contact a last level of no row follows: it has the cost of the forces, as the last level
    of the whole order does.
    """
    kept = {task for level in order[:depth] for task in level}
    k = problem.alpha.shape[0]
    upper = problem.alpha.copy()
    for task in set(range(k)) - kept:
        upper[:, task], upper[task, :] = 0.0, 1.0
    starts = problem.starts
    if problem.contacts is not None:
        upper = np.pad(upper, ((0, 1), (0, 1)))
        upper[k, sorted(kept)] = 1.0
        upper[sorted(set(range(k)) - kept), k] = 1.0
        starts = np.append(starts, starts[-1])
    return replace(problem, starts=starts, priorities=Priorities.of(upper))


def _loss(
    problem: ghc.ControlProblem, tasks: list[int], whole: ghc.Solution, alone: ghc.Solution
) -> float:
    parts = [np.arange(problem.starts[task], problem.starts[task + 1]) for task in tasks]
    rows = np.concatenate(parts)
    lost = problem.jacobian[rows] @ (whole.acceleration - alone.acceleration)
    wanted = float(np.linalg.norm(problem.target[rows]))
    return float(np.linalg.norm(lost)) / max(wanted, LEAST_TARGET)


def ramp_step(
    formulation: str, settings: ghc.FormulationSettings, changes: Iterable[Change]
) -> float | None:
    """Largest of 100 equal steps of any ramp over its whole change of torque: 0.01 when even.

    None where no ramp changes anything, or a step of each has no answer.
    """
    shares = [
        share
        for change in changes
        if (share := _largest_step(formulation, settings, change)) is not None
    ]
    return max(shares, default=None)


def _largest_step(
    formulation: str, settings: ghc.FormulationSettings, change: Change
) -> float | None:
    solver = make_formulation(formulation, settings)
    torques = []
    for share in np.linspace(0.0, 1.0, STEPS + 1):
        pairs = (Candidate(change.before, 1.0 - share), Candidate(change.after, share))
        mixture = Priorities.mixed(pair for pair in pairs if pair.share > 0.0)
        answer = solver.solve(replace(change.problem, priorities=mixture))
        if answer.status is SolutionStatus.FAILED:
            return None
        torques.append(answer.torque)
    path = np.array(torques)
    whole = float(np.linalg.norm(path[-1] - path[0]))
    if whole < _LEAST_CHANGE:
        return None
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).max()) / whole

"""Ramps in 100 equal steps at a fixed state: how evenly does the torque change?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import ghc_controller as ghc
from benchmarks.random_tasks import strict_matrix
from ghc_controller.types import Array

STEPS = 100
_DT = 1e-3  # [s]
_SETTLE = 20  # steps before the first ramp: contact forces expand about those of the step before
_GIVEN_UP = 3  # unsolved steps after which a ramp is not followed further
_LEAST_CHANGE = 1e-3  # [Nm] a ramp that changes less has no shape to speak of

KINDS = (
    "strict to strict",
    "swap of the first two",
    "insertion",
    "removal",
    "cycle",
    "pre-empted",
)


@dataclass(frozen=True, slots=True)
class Ramp:
    """Result of one ramp."""

    largest_share: float  # of the whole change, in one step: 0.01 when even; nan: not solved
    unsolved: int  # steps
    finished: bool


def orders_of(
    kind: str, order: Sequence[int], rng: np.random.Generator
) -> list[tuple[Sequence[int], float]]:
    """Orders in sequence, each with the share at which the ramp to it is left.

    The first one is active at the start. A removed task is missing in its order.
    """
    first, second, third = order[:3]
    rest = list(order[3:])
    whole = list(order)
    if kind == "strict to strict":
        return [(whole, 1.0), (list(rng.permutation(order)), 1.0)]
    if kind == "swap of the first two":
        return [(whole, 1.0), ([second, first, third, *rest], 1.0)]
    if kind == "insertion":
        return [(whole[1:], 1.0), (whole, 1.0)]
    if kind == "removal":
        return [(whole, 1.0), (whole[1:], 1.0)]
    if kind == "cycle":
        turned = [[second, third, first, *rest], [third, first, second, *rest], whole]
        return [(whole, 1.0), *((turn, 1.0) for turn in turned)]
    swapped, last = [second, first, third, *rest], list(rng.permutation(order))
    if last == swapped:  # the ramp under way, given again, would go on
        last = whole[::-1]
    return [(whole, 1.0), (swapped, 0.5), (last, 1.0)]


def follow(
    controller: ghc.Controller,
    state: ghc.RobotState,
    orders: Sequence[tuple[Sequence[int], float]],
) -> list[Ramp]:
    """Ramp through orders, linear in time, with a controller started at rest at `state`."""
    names = controller.robot.task_names
    ramps: list[Ramp] = []
    time = 0.0
    for index, (order, left_at) in enumerate(orders):
        matrix = ghc.PriorityMatrix(names, strict_matrix(order, len(names)))
        steps = round(left_at * STEPS) if index else _SETTLE
        duration = STEPS * _DT if index else 0.0
        controller.add_transition(ghc.Transition(matrix, time, duration, ghc.Profile.LINEAR), time)
        torques: list[Array] = []
        unsolved = 0
        for step in range(steps + 1):
            result = controller.step(ghc.RobotState(time + step * _DT, state.q, state.v))
            torques.append(result.torque.copy())
            unsolved += result.status is not ghc.StepStatus.SOLVED
            if unsolved >= _GIVEN_UP:
                break
        time += steps * _DT
        if index:
            ramps.append(_judged(torques, unsolved, len(torques) == steps + 1))
            if not ramps[-1].finished:
                break
    return ramps


def _judged(torques: list[Array], unsolved: int, finished: bool) -> Ramp:
    path = np.array(torques)
    whole = np.abs(path[-1] - path[0]).max()
    share = np.nan
    if finished and not unsolved and whole > _LEAST_CHANGE:
        steps = np.abs(np.diff(path, axis=0)).max(axis=1)
        share = float(steps.max() / whole) * len(steps) / STEPS  # of a ramp left half-way, half
    return Ramp(share, unsolved, finished)

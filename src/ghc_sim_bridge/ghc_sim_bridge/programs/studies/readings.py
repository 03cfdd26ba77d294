"""Interpretations of eq. 4.14, and the overshoot of each (thesis: 31 %)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.qp import QpProblem, SolverSettings, make_solver
from ghc_controller.types import Array
from ghc_mpc_constraints.previews.horizon import Horizon, PreviewModel, integrator_chain
from ghc_sim_bridge.programs.studies.motion_study import SAFE, VIOLATION, MotionCase, roll

Limit = Callable[[Array], Array]  # preview -> limit of every point


@dataclass(frozen=True, slots=True)
class Reading:
    """One interpretation of the problem."""

    title: str
    order: int = 3  # integrators: 3 = jerk is the input
    limit: str = "all"  # points at which (4.14c) holds: all, none, inside, first inside
    smooth_input: bool = False  # weight on the change of the jerk instead of the jerk
    velocity_weight: float = 0.0  # [s^2] of the velocity, in addition to the position
    outside: float = SAFE  # [m] initial position of the obstacle

    def overshoot(self) -> float:
        """[%] of the steady state."""
        return roll(_case(self), _HORIZON, _solver(self), self.order).overshoot


READINGS = (
    Reading("eq. 4.14 as printed"),
    Reading("without the constraint (4.14c)", limit="none"),
    Reading("(4.14c) only where the obstacle is inside", limit="inside"),
    Reading("(4.14c) only at the end of the reaction time", limit="first inside"),
    Reading("weight on the change of the jerk", smooth_input=True),
    Reading("velocity in the cost, weight 0.01", velocity_weight=0.01),
    Reading("acceleration as the input (two integrators)", order=2),
    Reading("snap as the input (four integrators)", order=4),
    Reading("obstacle comes from 0.5 m, not from the edge at 0.4 m", outside=0.5),
)
_HORIZON = Horizon.of(0.02, 1.5 + 0.1)  # coarse: the overshoot does not depend on the step
_INPUT_WEIGHT = {2: 2.15e-3, 3: 1e-5, 4: 4.64e-8}  # [s^(2 order)] the same time constant


def _case(reading: Reading) -> MotionCase:
    return replace(
        MotionCase(step=_HORIZON.step, horizon=_HORIZON.duration),
        jerk_weight=_INPUT_WEIGHT[reading.order],
        outside=reading.outside,
    )


def _solver(reading: Reading) -> Callable[[Array, Array], float]:
    """First input of the dense QP of an interpretation."""
    model = integrator_chain(reading.order, _HORIZON)
    solver = make_solver("daqp", SolverSettings(tolerance=1e-8, max_pivots=4000))
    hessian, change = _hessian(reading, model)
    slope = _slope(model)
    last = 0.0

    def solve(state: Array, raw: Array) -> float:
        nonlocal last
        response = model.input_response
        free = model.state_response @ state
        linear = response.T @ (free - raw)
        if reading.velocity_weight:
            rest = slope @ free
            rest[0] -= state[0] / _HORIZON.step
            linear = linear + reading.velocity_weight * (slope @ response).T @ rest
        if reading.smooth_input:
            linear[0] -= change * last
        limit = _limit(reading, raw) - free
        problem = QpProblem(
            hessian,
            linear,
            np.zeros((0, len(raw))),
            np.zeros(0),
            np.array(response),
            np.full(len(raw), -np.inf),
            limit,
        )
        last = float(solver.solve(problem).x[0])
        return last

    return solve


def _slope(model: PreviewModel) -> Array:
    """(N, N) finite differences: positions to velocities."""
    steps = len(model.input_response)
    slope: Array = (np.eye(steps) - np.eye(steps, k=-1)) / _HORIZON.step
    return slope


def _hessian(reading: Reading, model: PreviewModel) -> tuple[Array, float]:
    response = model.input_response
    weight = _INPUT_WEIGHT[reading.order]
    hessian = response.T @ response
    slope = _slope(model)
    if reading.velocity_weight:
        hessian = hessian + reading.velocity_weight * (slope @ response).T @ (slope @ response)
    if reading.smooth_input:
        steps = slope * _HORIZON.step
        return hessian + weight * steps.T @ steps, weight
    return hessian + weight * np.eye(len(hessian)), 0.0


def _limit(reading: Reading, raw: Array) -> Array:
    inside = raw < SAFE - 0.5 * VIOLATION
    free = {
        "all": np.zeros_like(inside),
        "none": np.ones_like(inside),
        "inside": ~inside,
        "first inside": ~inside | inside.all() | (np.cumsum(inside) != 1),
    }[reading.limit]
    return np.where(free, 1e3, raw)

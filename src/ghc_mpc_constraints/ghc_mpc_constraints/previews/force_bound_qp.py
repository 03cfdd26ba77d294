"""Both force bounds of one contact over the horizon as one QP (eq. 5.6 to 5.8).

    min  sum_j (upper_j - Fmax_j)^2 + alpha rate_upper_j^2
             + (lower_j - Fmin_j)^2 + beta rate_lower_j^2
    s.t. Fmin_j <= lower_j <= upper_j <= Fmax_j,      rate_j = (bound_{j+1} - bound_j) / T

The rates are eliminated: the unknowns are the bounds at the points 1 .. N, so that (5.8d) is
almost a box and the Hessian is tridiagonal and the same for ever. Its inverse is made once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from ghc_controller.qp import QpProblem
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array
from ghc_mpc_constraints.previews.active_set import (
    CAPACITY,
    MAX_CHANGES,
    feasibility_tolerance,
    most_violated,
    take_in,
)
from ghc_mpc_constraints.previews.horizon import Horizon, integrator_chain
from ghc_mpc_constraints.previews.second_solver import SecondSolver


@dataclass(frozen=True, slots=True)
class ForceBoundWeights:
    """What a slow bound is worth against one close to the raw one."""

    upper_rate_weight: float = declared(
        "alpha of eq. 5.8: weight of the upper bound's rate; 0.05 to 0.8",
        0.1,
        unit="s^2",
        domain=POSITIVE,
    )
    lower_rate_weight: float = declared(
        "beta of eq. 5.8: weight of the lower bound's rate; 0.05 to 0.8",
        0.1,
        unit="s^2",
        domain=POSITIVE,
    )

    def __post_init__(self) -> None:
        """Raise InvalidValue for a weight that is not finite and positive."""
        check(self)


class ForceBoundQp:
    """Solves the QP of any contact; holds only what all contacts and ticks share."""

    def __init__(self, horizon: Horizon, weights: ForceBoundWeights) -> None:
        """Make the Hessians and their inverses."""
        self._horizon = horizon
        rates = np.linalg.inv(integrator_chain(1, horizon).input_response)  # (N, N), rate = . F
        self._weights = np.array([weights.upper_rate_weight, weights.lower_rate_weight])
        self._hessians = [np.eye(horizon.steps) + w * rates.T @ rates for w in self._weights]
        self._inverses = np.array([np.linalg.inv(hessian) for hessian in self._hessians])
        self.second = SecondSolver()

    def solve(
        self, start: tuple[float, float], raw_lower: Array, raw_upper: Array
    ) -> tuple[Array, Array] | None:
        """Lower and upper bound at the points 1 .. N; None when no solution was found.

        `start` is the pair (lower, upper) in force now [N]; raw bounds are (N,) with
        raw_lower <= raw_upper.
        """
        pulls = self._weights / self._horizon.step**2
        answer, solved = _solve(self._inverses, pulls, start[0], start[1], raw_lower, raw_upper)
        if not solved:
            written_out = self.second.solve(self.problem(start, raw_lower, raw_upper))
            if written_out is None:
                return None
            answer = written_out.reshape(2, -1)
        # To the last digit: the solver leaves 1e-9.
        upper = np.minimum(np.maximum(answer[0], raw_lower), raw_upper)
        lower = np.minimum(np.maximum(answer[1], raw_lower), upper)
        return lower, upper

    def problem(self, start: tuple[float, float], raw_lower: Array, raw_upper: Array) -> QpProblem:
        """The same QP written out: unknowns (upper_1 .. upper_N, lower_1 .. lower_N)."""
        steps = self._horizon.steps
        zero, one = np.zeros((steps, steps)), np.eye(steps)
        linear = -np.concatenate([raw_upper, raw_lower])
        linear[[0, steps]] -= self._weights / self._horizon.step**2 * np.array(start[::-1])
        free = np.full(steps, np.inf)
        return QpProblem(
            np.block([[self._hessians[0], zero], [zero, self._hessians[1]]]),
            linear,
            np.zeros((0, 2 * steps)),
            np.zeros(0),
            np.block([[one, zero], [zero, one], [one, -one]]),
            np.concatenate([-free, raw_lower, np.zeros(steps)]),
            np.concatenate([raw_upper, free, free]),
        )


@numba.njit(cache=True)
def _solve(
    inverses: Array,
    pulls: Array,
    lower_now: float,
    upper_now: float,
    raw_lower: Array,
    raw_upper: Array,
) -> tuple[Array, bool]:
    """(2, N) upper and lower bounds; rows y = (upper, -lower, lower - upper)."""
    steps = raw_upper.shape[0]
    target_upper, target_lower = raw_upper.copy(), raw_lower.copy()
    target_upper[0] += pulls[0] * upper_now
    target_lower[0] += pulls[1] * lower_now
    answer = np.empty((2, steps))
    answer[0] = np.dot(inverses[0], target_upper)
    answer[1] = np.dot(inverses[1], target_lower)
    y = np.concatenate((answer[0], -answer[1], answer[1] - answer[0]))
    bound = np.concatenate((raw_upper, -raw_lower, np.zeros(steps)))
    tolerance = feasibility_tolerance(bound)
    rows, multipliers = np.empty(CAPACITY, np.int64), np.empty(CAPACITY)
    columns = np.empty((CAPACITY, 3 * steps))
    count = 0
    for _ in range(MAX_CHANGES):
        row = most_violated(y, bound, tolerance)
        if row < 0:
            answer[0], answer[1] = y[:steps], -y[steps : 2 * steps]
            return answer, True
        if count == CAPACITY - 1:
            break
        rows[count] = row
        _write_column(inverses, row, columns[count])
        count = take_in(y, bound, rows, multipliers, columns, count)
        if count < 0:
            break
    return answer, False


@numba.njit(cache=True)
def _write_column(inverses: Array, row: int, out: Array) -> None:
    """C H^-1 C^T of one row."""
    steps = inverses.shape[1]
    kind, point = row // steps, row % steps
    for i in range(steps):
        upper = 0.0 if kind == 1 else inverses[0, i, point]
        lower = 0.0 if kind == 0 else inverses[1, i, point]
        if kind == 2:
            upper = -upper
        elif kind == 1:
            lower = -lower
        out[i] = upper
        out[steps + i] = -lower
        out[2 * steps + i] = lower - upper

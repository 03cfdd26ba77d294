"""Both force bounds of one contact over the horizon as one QP (eq. 5.6 to 5.8).

    min  sum_j (upper_j - Fmax_j)^2 + alpha rate_upper_j^2
             + (lower_j - Fmin_j)^2 + beta rate_lower_j^2
    s.t. Fmin_j <= lower_j <= upper_j <= Fmax_j,      rate_j = (bound_{j+1} - bound_j) / T

The rates are eliminated: the unknowns are the bounds at the points 1 .. N, so that (5.8d) is
almost a box and the Hessian is tridiagonal and constant. Its inverse is computed once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.core import native
from ghc_controller.qp import QpProblem
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array
from ghc_mpc_constraints.previews.horizon import Horizon, integrator_chain
from ghc_mpc_constraints.previews.second_solver import SecondSolver


@dataclass(frozen=True, slots=True)
class ForceBoundWeights:
    """Weights of the rate of a bound against its distance from the raw one."""

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
    """Solves the QP of one contact; stores only data shared by all contacts and ticks."""

    def __init__(self, horizon: Horizon, weights: ForceBoundWeights) -> None:
        """Compute the Hessians and their inverses."""
        self._horizon = horizon
        rates = np.linalg.inv(integrator_chain(1, horizon).input_response)  # (N, N), rate = . F
        self._weights = np.array([weights.upper_rate_weight, weights.lower_rate_weight])
        self._hessians = [np.eye(horizon.steps) + w * rates.T @ rates for w in self._weights]
        self._inverses = np.array([np.linalg.inv(hessian) for hessian in self._hessians])
        self.second = SecondSolver()

    def solve(
        self, start: tuple[float, float], raw_lower: Array, raw_upper: Array
    ) -> tuple[Array, Array] | None:
        """Lower and upper bound at the points 1 .. N; None if no solution was found.

        `start` is the current pair (lower, upper) [N]; raw bounds are (N,) with
        raw_lower <= raw_upper.
        """
        pulls = self._weights / self._horizon.step**2
        answer, solved = native.force_bounds(self._inverses, pulls, *start, raw_lower, raw_upper)
        if not solved:
            written_out = self.second.solve(self.problem(start, raw_lower, raw_upper))
            if written_out is None:
                return None
            answer = written_out.reshape(2, -1)
        # Clip: the solver leaves violations of 1e-9.
        upper = np.minimum(np.maximum(answer[0], raw_lower), raw_upper)
        lower = np.minimum(np.maximum(answer[1], raw_lower), upper)
        return lower, upper

    def problem(self, start: tuple[float, float], raw_lower: Array, raw_upper: Array) -> QpProblem:
        """The same QP in dense form: unknowns (upper_1 .. upper_N, lower_1 .. lower_N)."""
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

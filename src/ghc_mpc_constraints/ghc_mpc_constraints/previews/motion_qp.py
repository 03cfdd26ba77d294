"""Motion of a virtual obstacle along one axis over the horizon as one QP (eq. 4.14, 4.15).

    min  sum_j d_j (x_j - raw_j)^2 + gamma jerk_j^2      s.t.  x_j <= limit_j
    with x_{j+1} from the triple integrator of eq. 4.11

D changes the Hessian at each tick, so no inverse can be cached. Instead, a Riccati recursion over
the chain solves the problem for any linear term in O(N); the active-set method uses it for the
columns of the few active rows.
"""

from __future__ import annotations

import numpy as np

from ghc_controller.core import native
from ghc_controller.errors import InvalidValue
from ghc_controller.qp import QpProblem
from ghc_controller.types import Array
from ghc_mpc_constraints.previews.horizon import Horizon, integrator_chain
from ghc_mpc_constraints.previews.second_solver import SecondSolver

ORDER = 3  # position, velocity, acceleration; the jerk is the input


class MotionQp:
    """Solves the QP of any axis of any obstacle."""

    def __init__(self, horizon: Horizon, jerk_weight: float) -> None:
        """`jerk_weight` is gamma [s^6]."""
        if not (np.isfinite(jerk_weight) and jerk_weight > 0.0):
            raise InvalidValue(
                f"jerk_weight = {jerk_weight} given, a finite number above 0 expected"
            )
        self._step = horizon.step
        self._model = integrator_chain(ORDER, horizon)
        self._jerk_weight = jerk_weight
        self.second = SecondSolver()

    def solve(self, state: Array, raw: Array, weights: Array, limit: Array) -> Array | None:
        """Jerks (N,) [m/s^3] of the optimal motion; None if no solution was found.

        `state` (3,) position, velocity, acceleration now; `raw` (N,) preview [m]; `weights` (N,)
        diagonal of D; `limit` (N,) largest position [m], inf = no limit.
        """
        jerk, solved = native.bounded_motion(
            self._step, state, raw, weights, limit, self._jerk_weight
        )
        if solved:
            return jerk
        return self.second.solve(self.problem(state, raw, weights, limit))

    def problem(self, state: Array, raw: Array, weights: Array, limit: Array) -> QpProblem:
        """The same QP in dense form in the jerks, with the stacked responses of eq. 4.13."""
        model = self._model
        free = model.state_response @ state
        response = model.input_response
        weighted = weights[:, None] * response
        return QpProblem(
            response.T @ weighted + self._jerk_weight * np.eye(len(raw)),
            weighted.T @ (free - raw),
            np.zeros((0, len(raw))),
            np.zeros(0),
            np.array(response),
            np.full(len(raw), -np.inf),
            limit - free,
        )

"""Solution of a control problem."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

import numpy as np

from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.types import Array

NO_FORCE = np.zeros(0)


class SolutionStatus(Enum):
    """How the torque came about; the numbers of ghc_msgs/ControllerState."""

    SOLVED = 0
    RELAXED = 1
    FAILED = 2


class Solution(NamedTuple):
    """Accelerations, contact forces and torques of one control problem."""

    acceleration: Array  # (n,) x
    force: Array  # (c,) contact forces
    torque: Array  # (a,) [Nm]
    status: SolutionStatus
    qp_solved: bool  # False: the unconstrained optimum met every bound
    primal_residual: float = 0.0  # largest violation of a row of the QP, as `violation`
    dual_residual: float = 0.0
    iterations: int = 0
    acceleration_slack: Array | None = None  # (n,) relaxation of the soft box
    rows_slack: Array | None = None  # (r,) relaxation of the general rows
    force_slack: Array | None = None  # (r,) relaxation of the rows on contact forces [N]
    rate_gave_way: bool = False
    progress: float = 0.0  # [-] of a ramp with a torque-rate budget
    levels_dropped: int = 0  # last levels that have no part in it: no pivot was left for them
    violation: float = 0.0  # [rad/s^2], [Nm] or [N] largest one of a row, relaxation aside
    reason: str = ""  # in words, if the status is FAILED or the solution is only feasible
    of_candidates: tuple[Array, ...] = ()  # (c,) forces of each, if each has its own cost on them

    @classmethod
    def without_answer(cls, problem: ControlProblem, reason: str) -> Solution:
        """No answer to a problem: NaN, and the reason in words."""
        n = problem.bias.shape[0]
        return cls(
            np.full(n, np.nan),
            np.zeros(0),
            np.full(n - problem.unactuated, np.nan),
            SolutionStatus.FAILED,
            True,
            violation=np.inf,
            reason=reason,
        )

    @classmethod
    def unbounded(cls, acceleration: Array, torque: Array, force: Array = NO_FORCE) -> Solution:
        """The unconstrained optimum, which met every bound: no QP was needed."""
        return cls(acceleration, force, torque, SolutionStatus.SOLVED, qp_solved=False)

"""The interface that every formulation shares, and the choice between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.formulations.problem import ControlProblem
from ghc_controller.hierarchy.directions import Starts
from ghc_controller.hierarchy.projector import (
    ProjectorSettings,
    generalized_projectors,
    smallest_singular_value,
)
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array


class TorqueRegularization(Enum):
    """What the weight on torque pulls to; around zero it costs task error under gravity."""

    NONE = "none"
    BIAS = "bias"  # tau - h
    ZERO = "zero"  # tau


_POSITIVE = (
    "regularization",
    "torque_weight",
    "null_damping",
    "metric_ratio",
    "weight_ratio",
    "rank_tolerance",
)


@dataclass(frozen=True, slots=True)
class FormulationSettings:
    """Numbers shared by the formulations.

    Raises:
        InvalidValue: a weight that is not positive, a negative velocity_damping.
    """

    regularization: float = 1e-2  # [-] w: weight on nu'_i (ghc) or damping |x|^2 per level
    torque_regularization: TorqueRegularization = TorqueRegularization.NONE
    torque_weight: float = 1e-2  # [-] on |tau - reference|^2, ghc and ghc_full only
    velocity_damping: float = 20.0  # [1/s] kd: regularization pulls accelerations to -kd v
    null_damping: float = 3e-5  # [-] e of the null spaces of cascade
    metric_ratio: float = 1e3  # [-] kappa: what yields between two levels under active bounds
    weight_ratio: float = 1e2  # [-] between two levels of the weighted formulation
    rank_tolerance: float = 1e-4  # [-] of the largest singular value, hqp only
    hqp_damps_velocity: bool = False  # hqp damps x + kd v like the others, instead of x
    second_order: bool = False  # (x + kd v)^T S (x + kd v) of every task beside |J x - b|^2
    projector: ProjectorSettings = field(default_factory=ProjectorSettings)

    def __post_init__(self) -> None:
        for name in _POSITIVE:
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InvalidValue(f"{name} = {value} given, a positive number expected")
        if not (np.isfinite(self.velocity_damping) and self.velocity_damping >= 0.0):
            raise InvalidValue(
                f"velocity_damping = {self.velocity_damping} 1/s given, at least 0 expected"
            )


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
    acceleration_slack: Array | None = None  # (n,) by how far the soft box gave way
    rows_slack: Array | None = None  # (r,) by how far the general rows gave way
    force_slack: Array | None = None  # (r,) by how far the rows on contact forces gave way [N]
    rate_gave_way: bool = False
    progress: float = 0.0  # [-] of a ramp with a torque-rate budget
    levels_dropped: int = 0  # last levels that have no part in it: no pivot was left for them
    violation: float = 0.0  # [rad/s^2], [Nm] or [N] largest one of a row, what gave way aside
    reason: str = ""  # in words, where the status is FAILED or the answer is feasible and no more

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


class Formulation(ABC):
    """Turns a control problem into accelerations, contact forces and torques."""

    name: str
    layer_damping: float = 0.0  # [-] where the settings leave it open
    takes_second_order: bool = True
    blends: bool = False  # answers each candidate of a mixture: can keep a torque-rate budget

    def __init__(self, settings: FormulationSettings, solver: QpSolver) -> None:
        """Raises InvalidValue where `second_order` is set and the formulation does not take it."""
        if settings.second_order and not self.takes_second_order:
            raise InvalidValue(
                f"second_order: formulation {self.name} does not take it: its x = sum_i P_i nu_i "
                "minimizes |J_i nu_i - b_i|^2 + w |nu_i|^2, and the identities that condense it, "
                "such as J_i^T (J_i J_i^T + w I)^-1 b_i, do not hold with S_i; take cascade, "
                "balanced, hqp or weighted"
            )
        self.settings = settings
        self.solver = solver
        self.projector = settings.projector.with_default(self.layer_damping)

    @abstractmethod
    def solve(self, problem: ControlProblem) -> Solution:
        """Solve one tick; `status` is FAILED when no answer meets the hard rows."""

    def solvability(self, jacobian: Array, starts: Starts) -> Solvability:
        """What transitions must keep, by default a solution of eq. 13b.

        Args:
            jacobian: (m, d) rows of all tasks in the accelerations that keep the contacts.
            starts: (k + 1,) first row of each task.
        """

        def measure(alpha: Array) -> float:
            if (alpha.sum(axis=1) == 0.0).any():
                return 1.0  # a projector that is the identity is enough
            projectors = generalized_projectors(jacobian, starts, alpha, self.projector)
            return smallest_singular_value(projectors)

        return Solvability(measure, along_ramp=not self.blends)

"""The interface that every formulation shares, and the choice between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.directions import Starts
from ghc_controller.hierarchy.projector import (
    ProjectorSettings,
    generalized_projectors,
    smallest_singular_value,
)
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.types import Array


class TorqueRegularization(Enum):
    """What the weight on torque pulls to; around zero it costs task error under gravity."""

    NONE = "none"
    BIAS = "bias"  # tau - h
    ZERO = "zero"  # tau


class Metric(Enum):
    """What accelerations make least beside the tasks, and in which projectors are orthogonal."""

    ACCELERATION = "acceleration"  # |x|^2: resolved acceleration
    INERTIA = "inertia"  # x^T M x: operational space, dynamically consistent projectors
    TORQUE = "torque"  # |M x|^2: least torque


class DampedLevels(Enum):
    """Levels of the closed laws for strict orders that w damps (task_priority and its baselines).

    The names are in the terms of Jeong and Chang 2009.
    """

    ALL = "all"  # eq. 27, and level 1 as well: bounded at every singularity
    LOWER = "lower"  # eq. 27 as printed: level 1 is exact
    NONE = "none"  # eq. 18


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
    rank_tolerance: float = 1e-4  # [-] of the largest singular value; rhp_hqp: of a row
    hqp_damps_velocity: bool = False  # hqp and its kin damp x + kd v like the others, not x
    metric: Metric = Metric.ACCELERATION  # task_priority and ghc
    damped_levels: DampedLevels = DampedLevels.ALL  # task_priority and its baselines
    rhp_constant_weights: bool = False  # rows of rhp_hqp count alike at any phi; jumps in a swap
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

    def reset(self) -> None:
        """Forget earlier problems: the next answers are those of a new formulation."""
        self.solver.reset()

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

"""The interface that every formulation shares, and the choice between them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.projector import (
    ProjectorSettings,
    generalized_projectors,
    smallest_singular_value,
)
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.problem.control_problem import ControlProblem
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpSolver
from ghc_controller.schema.declared import check, declared, inline
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE
from ghc_controller.types import Array, Starts

# [-] of velocity_damping beside second-order terms. KUKA, 20 1/s, first task and speed left: 1.4
# and 1.9 times those without terms with 1, 0.3 and 0.9 times with 1/2.
_BESIDE_TERMS = 0.25


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


@dataclass(frozen=True, slots=True)
class FormulationSettings:
    """Numbers shared by the formulations.

    Raises:
        InvalidValue: a number outside its range.
    """

    regularization: float = declared(
        "w: weight on nu'_i (ghc), or damping of every level", 1e-2, unit="-", domain=POSITIVE
    )
    velocity_damping: float = declared(
        "kd: damping pulls to -kd v, with second_order to a quarter of it; 0 = to zero, as in the "
        "papers",
        20.0,
        unit="1/s",
        domain=NOT_NEGATIVE,
    )
    null_damping: float = declared(
        "e: null spaces of cascade open over singular values of this size",
        3e-5,
        unit="-",
        domain=POSITIVE,
    )
    torque_regularization: TorqueRegularization = declared(
        "what a weight on torque pulls to (ghc, ghc_full): none, bias or zero",
        TorqueRegularization.NONE,
    )
    torque_weight: float = declared(
        "of |tau - reference|^2 (ghc, ghc_full)", 1e-2, unit="-", domain=POSITIVE
    )
    metric_ratio: float = declared(
        "kappa: what yields between two levels of balanced under active bounds",
        1e3,
        unit="-",
        domain=POSITIVE,
    )
    weight_ratio: float = declared(
        "between two levels of weighted", 1e2, unit="-", domain=POSITIVE
    )
    rank_tolerance: float = declared(
        "of the largest singular value; rhp_hqp: of a row", 1e-4, unit="-", domain=POSITIVE
    )
    hqp_damps_velocity: bool = declared(
        "hqp and its kin damp towards -kd v as well; false = damping of the literature", False
    )
    metric: Metric = declared(
        "what task_priority and ghc make least beside the tasks: acceleration, inertia "
        "(operational space, dynamically consistent projectors) or torque",
        Metric.ACCELERATION,
    )
    damped_levels: DampedLevels = declared(
        "levels that w damps in task_priority and its baselines: all, lower (all but the first) "
        "or none",
        DampedLevels.ALL,
    )
    rhp_constant_weights: bool = declared(
        "rhp_hqp weighs rows alike at any phi, as its authors' library; jumps in a swap", False
    )
    second_order: bool = declared(
        "add the curvature of the tasks to every level; cascade, balanced, hqp and weighted take "
        "it",
        False,
    )
    projector: ProjectorSettings = inline(ProjectorSettings)

    def __post_init__(self) -> None:
        check(self)

    @property
    def rest_damping(self) -> float:
        """kd [1/s] of the damping w |x + kd v|^2 that is in force.

        Second-order terms brake as well, by S (x + kd_task v), where a level loses directions.
        Both slow a task: it converges at kp s / (kd_task s + kd w + kd_task S), s = sigma^2.
        """
        return (_BESIDE_TERMS if self.second_order else 1.0) * self.velocity_damping


class Formulation(ABC):
    """Turns a control problem into accelerations, contact forces and torques."""

    name: str
    layer_damping: float = 0.0  # [-] where the settings leave it open
    takes_second_order: bool = True
    # Why not, where it does not.
    linear_because: str = "its levels are rows of Jacobians alone, as in its paper"
    blends: bool = False  # answers each candidate of a mixture: can keep a torque-rate budget
    # Declared dataclass of the settings that only this formulation has: a third argument of it.
    own_settings: type | None = None

    def __init__(self, settings: FormulationSettings, solver: QpSolver) -> None:
        """Raises InvalidValue where `second_order` is set and the formulation does not take it."""
        if settings.second_order and not self.takes_second_order:
            raise InvalidValue(
                f"second_order: formulation {self.name} does not take it: {self.linear_because}; "
                "take cascade, balanced, hqp or weighted"
            )
        self.settings = settings
        self.solver = solver
        self.projector = settings.projector.with_default(self.layer_damping)

    def retune(self, **numbers: Any) -> None:
        """Change numbers of `settings` on which the answers depend continuously.

        Raises:
            InvalidValue: a number outside its range.
        """
        self.settings = replace(self.settings, **numbers)

    @property
    def answers_candidates(self) -> bool:
        """Whether candidates of a mixture are answered each with a cost on forces of its own."""
        return self.blends

    @abstractmethod
    def solve(self, problem: ControlProblem) -> Solution:
        """Solve one tick; `status` is FAILED when no answer meets the hard rows."""

    def answer(self, problem: ControlProblem) -> Solution:
        """Solve one tick; a problem that is not finite has no answer, and its reason says so."""
        name = problem.not_finite()
        if name:
            return Solution.without_answer(problem, f"{name} of the control problem is not finite")
        return self.solve(problem)

    def reset(self) -> None:
        """Discard the state of earlier problems: solutions are then those of a new formulation."""
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

"""Formulations: ways to turn tasks, priorities and limits into torques, behind one interface.

A new one is a new file with a Formulation, under the decorator `@register_formulation`.
"""

from ghc_controller.formulations.formulation import (
    DampedLevels,
    Formulation,
    FormulationSettings,
    Metric,
    TorqueRegularization,
)
from ghc_controller.formulations.registry import (
    DEFAULT_FORMULATION,
    FORMULATIONS,
    blending_formulations,
    make_formulation,
    own_settings,
    register_formulation,
)
from ghc_controller.problem.control_problem import (
    AccelerationRows,
    ContactRows,
    ControlProblem,
    ForceExpansion,
)
from ghc_controller.problem.solution import Solution, SolutionStatus

__all__ = [
    "DEFAULT_FORMULATION",
    "FORMULATIONS",
    "AccelerationRows",
    "ContactRows",
    "ControlProblem",
    "DampedLevels",
    "ForceExpansion",
    "Formulation",
    "FormulationSettings",
    "Metric",
    "Solution",
    "SolutionStatus",
    "TorqueRegularization",
    "blending_formulations",
    "make_formulation",
    "own_settings",
    "register_formulation",
]

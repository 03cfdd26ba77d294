"""Priorities between tasks: matrix, hierarchy strings, transitions and generalized projectors."""

from ghc_controller.hierarchy.hierarchy_string import format_hierarchy, matrix_from_hierarchy
from ghc_controller.hierarchy.priorities import Candidate, Priorities
from ghc_controller.hierarchy.priority_matrix import PriorityMatrix
from ghc_controller.hierarchy.projector import (
    ProjectorSettings,
    generalized_projectors,
    smallest_singular_value,
)
from ghc_controller.hierarchy.solvability import Solvability
from ghc_controller.hierarchy.transition import Profile, Transition
from ghc_controller.hierarchy.transition_schedule import (
    TransitionEvent,
    TransitionPhase,
    TransitionSchedule,
)

__all__ = [
    "Candidate",
    "Priorities",
    "PriorityMatrix",
    "Profile",
    "ProjectorSettings",
    "Solvability",
    "Transition",
    "TransitionEvent",
    "TransitionPhase",
    "TransitionSchedule",
    "format_hierarchy",
    "generalized_projectors",
    "matrix_from_hierarchy",
    "smallest_singular_value",
]

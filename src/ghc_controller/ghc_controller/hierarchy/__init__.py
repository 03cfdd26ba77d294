"""Priorities between tasks: matrix, hierarchy strings, transitions and generalized projectors."""

from .hierarchy_string import format_hierarchy, matrix_from_hierarchy
from .priority_matrix import PriorityMatrix
from .projector import ProjectorSettings, generalized_projectors, smallest_singular_value
from .transition import Profile, Transition
from .transition_schedule import TransitionEvent, TransitionPhase, TransitionSchedule

__all__ = [
    "PriorityMatrix",
    "Profile",
    "ProjectorSettings",
    "Transition",
    "TransitionEvent",
    "TransitionPhase",
    "TransitionSchedule",
    "format_hierarchy",
    "generalized_projectors",
    "matrix_from_hierarchy",
    "smallest_singular_value",
]

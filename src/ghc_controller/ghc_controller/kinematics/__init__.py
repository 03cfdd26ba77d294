"""Velocity-level hierarchical least squares that resolves singularities (gn_qn_2018).

K. Pfeiffer, A. Escande, A. Kheddar, Singularity resolution in equality and inequality constrained
hierarchical task-space control by adaptive nonlinear least squares, RA-L 3(4), 2018.
"""

from ghc_controller.kinematics.hierarchy_solver import HierarchySolver
from ghc_controller.kinematics.level import Level
from ghc_controller.kinematics.level_rows import LevelRows
from ghc_controller.kinematics.settings import MODELS, KinematicSettings
from ghc_controller.kinematics.task_solver import TaskSolver
from ghc_controller.kinematics.trust_region import TrustRegion

__all__ = [
    "MODELS",
    "HierarchySolver",
    "KinematicSettings",
    "Level",
    "LevelRows",
    "TaskSolver",
    "TrustRegion",
]

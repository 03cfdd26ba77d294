"""Generalized Hierarchical Control by torque: the public names.

Names are loaded when they are first used, so that a program pays for what it uses only.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ghc_controller.constraints import DistanceConstraint as DistanceConstraint
    from ghc_controller.contacts.contact import Contact as Contact
    from ghc_controller.controller import Controller as Controller
    from ghc_controller.errors import GhcError as GhcError
    from ghc_controller.formulations import FORMULATIONS as FORMULATIONS
    from ghc_controller.formulations import Formulation as Formulation
    from ghc_controller.formulations import FormulationSettings as FormulationSettings
    from ghc_controller.formulations import register_formulation as register_formulation
    from ghc_controller.hierarchy import PriorityMatrix as PriorityMatrix
    from ghc_controller.hierarchy import Profile as Profile
    from ghc_controller.hierarchy import Transition as Transition
    from ghc_controller.hierarchy import matrix_from_hierarchy as matrix_from_hierarchy
    from ghc_controller.problem.control_problem import ControlProblem as ControlProblem
    from ghc_controller.problem.solution import Solution as Solution
    from ghc_controller.qp import QpSolver as QpSolver
    from ghc_controller.qp import register_solver as register_solver
    from ghc_controller.references.reference import ReferenceTrajectory as ReferenceTrajectory
    from ghc_controller.report.report import Report as Report
    from ghc_controller.report.report import StepResult as StepResult
    from ghc_controller.report.report import StepStatus as StepStatus
    from ghc_controller.robot.library import list_robots as list_robots
    from ghc_controller.robot.library import load_robot as load_robot
    from ghc_controller.robot.robot import Robot as Robot
    from ghc_controller.robot.task_entries import TaskEntry as TaskEntry
    from ghc_controller.robot.task_entries import center_of_mass as center_of_mass
    from ghc_controller.robot.task_entries import frame_orientation as frame_orientation
    from ghc_controller.robot.task_entries import frame_pose as frame_pose
    from ghc_controller.robot.task_entries import frame_position as frame_position
    from ghc_controller.robot.task_entries import posture as posture
    from ghc_controller.settings import Settings as Settings
    from ghc_controller.settings import register_constraint as register_constraint
    from ghc_controller.tasks.registry import register_task as register_task
    from ghc_controller.tasks.task import Task as Task
    from ghc_controller.types import RobotState as RobotState

__version__ = "0.1.0"

_HOMES = {
    "Contact": "contacts.contact",
    "ControlProblem": "problem.control_problem",
    "Controller": "controller",
    "DistanceConstraint": "constraints",
    "FORMULATIONS": "formulations",
    "Formulation": "formulations",
    "FormulationSettings": "formulations",
    "GhcError": "errors",
    "PriorityMatrix": "hierarchy",
    "Profile": "hierarchy",
    "QpSolver": "qp",
    "ReferenceTrajectory": "references.reference",
    "Report": "report.report",
    "Robot": "robot.robot",
    "RobotState": "types",
    "Settings": "settings",
    "Solution": "problem.solution",
    "StepResult": "report.report",
    "StepStatus": "report.report",
    "Task": "tasks.task",
    "Transition": "hierarchy",
    "list_robots": "robot.library",
    "load_robot": "robot.library",
    "matrix_from_hierarchy": "hierarchy",
    "TaskEntry": "robot.task_entries",
    "center_of_mass": "robot.task_entries",
    "frame_orientation": "robot.task_entries",
    "frame_pose": "robot.task_entries",
    "frame_position": "robot.task_entries",
    "posture": "robot.task_entries",
    "register_constraint": "settings",
    "register_formulation": "formulations",
    "register_solver": "qp",
    "register_task": "tasks.registry",
}
__all__ = ["__version__", *_HOMES]


def __getattr__(name: str) -> object:
    from ghc_controller.migration.public_names import load_name  # not before it is needed

    return load_name(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted(__all__)


class _OldModules:
    """Finder that Python tries last, for modules of this project that no other one has found."""

    @staticmethod
    def find_spec(fullname: str, *_: object) -> None:
        """Find nothing; ModuleNotFoundError with the new name for one of an earlier version."""
        if fullname.startswith(("ghc_controller.", "ghc_mpc_constraints.", "ghc_sim_bridge.")):
            from ghc_controller.migration.moved import raise_if_moved  # not before it is needed

            raise_if_moved(fullname)


sys.meta_path.append(_OldModules)

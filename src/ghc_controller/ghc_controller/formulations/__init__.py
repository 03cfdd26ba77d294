"""Formulations: ways to turn tasks, priorities and limits into torques, behind one interface.

A new one is a new file with a Formulation, and one line in FORMULATIONS.
"""

from ghc_controller.errors import UnknownName
from ghc_controller.formulations.balanced import BalancedGhc
from ghc_controller.formulations.baselines.operational_space import OperationalSpace
from ghc_controller.formulations.baselines.resolved_acceleration import ResolvedAcceleration
from ghc_controller.formulations.baselines.task_priority import TaskPriority
from ghc_controller.formulations.baselines.unifying import Unifying
from ghc_controller.formulations.cascade.cascade import Cascade
from ghc_controller.formulations.formulation import (
    DampedLevels,
    Formulation,
    FormulationSettings,
    Metric,
    TorqueRegularization,
)
from ghc_controller.formulations.ghc import CondensedGhc
from ghc_controller.formulations.ghc_full import FullGhc
from ghc_controller.formulations.hqp import Hqp
from ghc_controller.formulations.hqp_transition import HqpTransition
from ghc_controller.formulations.rhp_hqp import RhpHqp
from ghc_controller.formulations.weighted import Weighted
from ghc_controller.problem.control_problem import AccelerationRows, ContactRows, ControlProblem
from ghc_controller.problem.solution import Solution, SolutionStatus
from ghc_controller.qp import QpSolver, make_solver

FORMULATIONS: dict[str, type[Formulation]] = {
    kind.name: kind
    for kind in (
        *(Cascade, CondensedGhc, FullGhc, BalancedGhc, Hqp, Weighted),
        *(TaskPriority, ResolvedAcceleration, OperationalSpace, Unifying),
        *(RhpHqp, HqpTransition),
    )
}
DEFAULT_FORMULATION = Cascade.name


def make_formulation(
    name: str, settings: FormulationSettings | None = None, solver: QpSolver | None = None
) -> Formulation:
    """Formulation of that name.

    Raises:
        UnknownName: no such formulation; the message lists those that exist.
    """
    if name not in FORMULATIONS:
        raise UnknownName("formulation", name, FORMULATIONS)
    return FORMULATIONS[name](settings or FormulationSettings(), solver or make_solver("daqp"))


__all__ = [
    "DEFAULT_FORMULATION",
    "FORMULATIONS",
    "AccelerationRows",
    "ContactRows",
    "ControlProblem",
    "DampedLevels",
    "Formulation",
    "FormulationSettings",
    "Metric",
    "Solution",
    "SolutionStatus",
    "TorqueRegularization",
    "make_formulation",
]

"""Status of a controller: report of the last step, and counts over all steps."""

from __future__ import annotations

from ghc_controller.constraints import ConstraintSet
from ghc_controller.constraints.obstacle import ObstacleDistance
from ghc_controller.contacts import BoundsInForce, ContactSet
from ghc_controller.formulations import Formulation
from ghc_controller.hierarchy import TransitionSchedule
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.report.report import ObstacleReport, Report, StepResult, StepStatus
from ghc_controller.report.reporting import (
    Limits,
    contact_report,
    limit_reports,
    load_report,
    make_report,
    task_reports,
)
from ghc_controller.safety.gate import OutputGate
from ghc_controller.tasks.stack import TaskStack


class StatusReports:
    """The part of `Controller` that reports its status."""

    formulation: Formulation
    stack: TaskStack
    references: ReferenceSchedule
    priorities: TransitionSchedule
    contacts: ContactSet
    force_bounds: BoundsInForce
    obstacles: ObstacleDistance
    constraints: ConstraintSet
    gate: OutputGate
    counts: dict[str, int]
    _last: StepResult | None
    _limits: Limits | None

    @property
    def has_stepped(self) -> bool:
        """Whether a step was made since the start or the last reset."""
        return self._last is not None

    def report(self) -> Report:
        """Status of the last step; call it before the next one.

        Raises:
            RuntimeError: no step was made yet.
        """
        result, limits = self._last, self._limits
        if result is None or limits is None:
            raise RuntimeError("report() needs a step() before it")
        contacts = contact_report(
            self.contacts, self.force_bounds.planned, limits.normal_bounds, result.solution.force
        )
        loads = load_report(self.contacts, limits.normal_bounds, result.solution.force)
        states = self.obstacles.states(result.time)
        return make_report(
            result,
            limits,
            task_reports(self.stack, self.references, result.time),
            self.priorities.alpha,
            self.priorities.sigma_min,
            contacts,
            loads,
            tuple(ObstacleReport(planned, state) for planned, state in states),
            self.counts | self.formulation.solver.counts | self.gate.counts,
            limit_reports(self.constraints.limits, result.time),
        )

    def _count(self, status: StepStatus, levels_dropped: int) -> None:
        self.counts |= self.formulation.solver.counts
        self.counts["dropped_levels"] += levels_dropped
        if status is StepStatus.FALLBACK:
            self.counts["qp_failures"] += 1
            self.counts["fallback_ticks"] += 1
        elif status is StepStatus.RELAXED:
            self.counts["relaxed_ticks"] += 1

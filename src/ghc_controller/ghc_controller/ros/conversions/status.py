"""Conversions of the controller's status to messages: steps, priorities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import (
    BoundInForce,
    ContactState,
    ControllerState,
    NamedCount,
    PriorityMatrix,
    RowState,
    TaskState,
)

from ghc_controller.hierarchy import PriorityMatrix as TargetMatrix
from ghc_controller.hierarchy import TransitionSchedule, format_hierarchy
from ghc_controller.report.report import Report
from ghc_controller.ros.conversions.common import doubles
from ghc_controller.ros.time import time_from_seconds


def matrix_message(priorities: TransitionSchedule, time: float) -> PriorityMatrix:
    """The current matrix at `time` [s]."""
    message = PriorityMatrix(tasks=list(priorities.tasks))
    message.header.stamp = time_from_seconds(time)
    message.alpha = np.asarray(priorities.alpha).ravel().tolist()
    message.hierarchy = format_hierarchy(priorities.target)
    message.in_transition = priorities.in_transition
    message.mixture, message.shares = _mixture(priorities)
    return message


def _mixture(priorities: TransitionSchedule) -> tuple[list[str], list[float]]:
    """Targets in force, as strings, and their shares."""
    candidates = priorities.in_force.candidates
    names = [format_hierarchy(TargetMatrix(priorities.tasks, c.alpha)) for c in candidates]
    return names, [candidate.share for candidate in candidates]


def controller_state_message(
    report: Report,
    priorities: TransitionSchedule,
    epoch: int,
    formulation: str,
    solver: str,
    joint_names: Sequence[str],
) -> ControllerState:
    """Status of one control step."""
    result, solution = report.result, report.result.solution
    message = ControllerState(epoch=epoch, formulation=formulation, joint_names=list(joint_names))
    message.header.stamp = time_from_seconds(result.time)
    message.tasks = [
        TaskState(
            name=task.name,
            error=doubles(task.error),
            error_norm=task.motion_error,
            force_error=task.force_error,
            reference=doubles(task.target.position),
        )
        for task in report.tasks
    ]
    message.alpha = doubles(report.alpha)
    message.mixture, message.shares = _mixture(priorities)
    message.status = result.status.value
    message.solver = solver if solution.qp_solved else "none"
    message.qp_solved = solution.qp_solved
    message.primal_residual = solution.primal_residual
    message.dual_residual = solution.dual_residual
    message.sigma_min = report.sigma_min
    message.rows = _rows(report)
    message.fallback_reason = report.fallback_reason
    message.counts = [
        NamedCount(name=name, count=count) for name, count in sorted(report.counts.items())
    ]
    message.torque = doubles(result.torque)
    message.contacts = _contacts(report)
    message.bounds = [
        BoundInForce(kind=limit.kind, row=limit.joint, lower=limit.lower, upper=limit.upper)
        for limit in report.limits
    ]
    message.time_terms = result.time_terms
    message.time_solve = result.time_solve
    message.time_step = result.time_step
    return message


def _rows(report: Report) -> list[RowState]:
    """Rows at their bound, then those that were only relaxed."""
    slack = {row.name: row.amount for row in report.slack}
    rows = [
        RowState(name=name, active=True, slack=slack.pop(name, 0.0))
        for name in report.active_constraints
    ]
    return rows + [RowState(name=name, slack=amount) for name, amount in slack.items()]


def _contacts(report: Report) -> list[ContactState]:
    """Contacts that a generator bounds, then others that are on."""
    bounds, loads = report.contacts, report.loads
    states = {
        name: ContactState(name=name, planned=True, lower=lower, upper=upper, force=force)
        for name, lower, upper, force in zip(
            bounds.names,
            bounds.lower.tolist(),
            bounds.upper.tolist(),
            bounds.force.tolist(),
            strict=True,
        )
    }
    for name, normal, use in zip(
        loads.names, loads.normal.tolist(), loads.friction_use.tolist(), strict=True
    ):
        state = states.setdefault(name, ContactState(name=name, force=normal))
        state.on, state.friction_use = True, use
    return list(states.values())

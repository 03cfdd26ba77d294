"""Conversions of the controller's status to messages: steps, priorities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import (
    BoundInForce,
    ControllerState,
    NamedCount,
    PriorityMatrix,
    TaskState,
)

from ghc_controller.hierarchy import PriorityMatrix as TargetMatrix
from ghc_controller.hierarchy import TransitionSchedule, format_hierarchy
from ghc_controller.report.report import Report
from ghc_controller.ros.conversions.common import doubles
from ghc_controller.ros.time import time_from_seconds


def matrix_message(priorities: TransitionSchedule, time: float) -> PriorityMatrix:
    """The matrix in force at `time` [s]."""
    message = PriorityMatrix(tasks=list(priorities.tasks))
    message.header.stamp = time_from_seconds(time)
    message.alpha = np.asarray(priorities.alpha).ravel().tolist()
    message.hierarchy = format_hierarchy(priorities.target)
    message.in_transition = priorities.in_transition
    for candidate in priorities.in_force.candidates:
        target = TargetMatrix(priorities.tasks, candidate.alpha)
        message.mixture.append(format_hierarchy(target))
        message.shares.append(candidate.share)
    return message


def controller_state_message(
    report: Report, formulation: str, solver: str, joint_names: Sequence[str]
) -> ControllerState:
    """Account of one control step."""
    result, solution = report.result, report.result.solution
    message = ControllerState(formulation=formulation, joint_names=list(joint_names))
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
    message.status = result.status.value
    message.solver = solver if solution.qp_solved else "none"
    message.qp_solved = solution.qp_solved
    message.primal_residual = solution.primal_residual
    message.dual_residual = solution.dual_residual
    message.sigma_min = report.sigma_min
    message.active_constraints = list(report.active_constraints)
    message.slack_names = [slack.name for slack in report.slack]
    message.slack = [slack.amount for slack in report.slack]
    message.fallback_reason = report.fallback_reason
    message.counts = [
        NamedCount(name=name, count=count) for name, count in sorted(report.counts.items())
    ]
    message.torque = doubles(result.torque)
    message.bounded_contacts = list(report.contacts.names)
    message.contact_lower = doubles(report.contacts.lower)
    message.contact_upper = doubles(report.contacts.upper)
    message.contact_forces = doubles(report.contacts.force)
    message.contacts = list(report.loads.names)
    message.normal_forces = doubles(report.loads.normal)
    message.friction_use = doubles(report.loads.friction_use)
    message.bounds = [
        BoundInForce(kind=limit.kind, row=limit.joint, lower=limit.lower, upper=limit.upper)
        for limit in report.limits
    ]
    message.time_terms = result.time_terms
    message.time_solve = result.time_solve
    message.time_step = result.time_step
    return message

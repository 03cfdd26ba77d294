"""Report of a control step: names and copies, made on demand from what the step left."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.constraints import Box, Boxes, Slack
from ghc_controller.contacts import ContactSet, NormalBounds
from ghc_controller.previews.limits_in_force import LimitsInForce
from ghc_controller.problem.control_problem import AccelerationRows, ContactRows
from ghc_controller.problem.solution import Solution
from ghc_controller.qp import QpStatus
from ghc_controller.references.schedule import ReferenceSchedule
from ghc_controller.report.report import (
    ContactReport,
    LimitReport,
    LoadReport,
    ObstacleReport,
    Report,
    StepResult,
    StepStatus,
    TaskReport,
)
from ghc_controller.tasks.stack import TaskStack
from ghc_controller.types import Array

_ACTIVE = 1e-6  # [N] or [rad/s^2], of a row's size: this near a bound it is active


@dataclass(frozen=True, slots=True)
class Limits:
    """What bounded one step."""

    boxes: Boxes
    contact_rows: ContactRows | None
    normal_bounds: NormalBounds
    rows: AccelerationRows | None


def make_report(
    result: StepResult,
    limits: Limits,
    tasks: tuple[TaskReport, ...],
    alpha: Array,
    sigma_min: float,
    contacts: ContactReport,
    loads: LoadReport,
    obstacles: tuple[ObstacleReport, ...],
    counts: Mapping[str, int],
    planned: tuple[LimitReport, ...] = (),
) -> Report:
    """Report of a step; `alpha` (k, k) is copied."""
    boxes, solution = limits.boxes, result.solution
    active: tuple[str, ...] = ()
    slack = boxes.acceleration.slack + boxes.torque.slack
    reason = ""
    if result.status is StepStatus.FALLBACK:
        reason = _fallback_reason(limits, solution)
    else:
        active = boxes.acceleration.active(solution.acceleration)
        active += boxes.torque.active(solution.torque)
        active += _active_rows(limits, solution)
        slack += _box_slack(solution, boxes.acceleration) + _rows_slack(limits, solution)
    return Report(
        result,
        tasks,
        alpha.copy(),
        sigma_min,
        active,
        slack,
        reason,
        dict(counts),
        contacts,
        loads,
        obstacles,
        planned,
    )


def limit_reports(limits: Sequence[LimitsInForce], time: float) -> tuple[LimitReport, ...]:
    """Limits of joints that follow previews at a time [s]."""
    reports = []
    for one in limits:
        now = one.at(time)
        for joint in one.planned:
            place = one.place_of(joint)
            bounds = float(now.lower[place]), float(now.upper[place])
            reports.append(LimitReport(one.kind, joint, *bounds))
    return tuple(reports)


def task_reports(
    stack: TaskStack, references: ReferenceSchedule, time: float
) -> tuple[TaskReport, ...]:
    """Errors and targets of all tasks at the last update."""
    return tuple(_task_report(stack, references, i, time) for i in range(len(stack.tasks)))


def contact_report(
    contacts: ContactSet, planned: tuple[str, ...], bounds: NormalBounds, force: Array
) -> ContactReport:
    """Bounds and forces of the contacts that a generator bounds."""
    places = [contacts.names.index(name) for name in planned]
    normal = contacts.normal_forces(bounds.active, force)
    return ContactReport(planned, bounds.lower[places], bounds.upper[places], normal[places])


def load_report(contacts: ContactSet, bounds: NormalBounds, force: Array) -> LoadReport:
    """Forces of the contacts that are on, planned or not."""
    places = [place for place, on in enumerate(bounds.active) if on]
    normal = contacts.normal_forces(bounds.active, force)
    use = contacts.friction_use(bounds.active, force)
    names = tuple(contacts.names[place] for place in places)
    return LoadReport(names, normal[places], use[places])


def _task_report(
    stack: TaskStack, references: ReferenceSchedule, index: int, time: float
) -> TaskReport:
    error, task = stack.error_of(index).copy(), stack.tasks[index]
    motion, force = _length(error), 0.0
    if stack.force_rows[index]:
        mask = task.force_row_mask
        motion, force = _length(error[~mask]), _length(error[mask])
    return TaskReport(task.name, error, motion, force, references.target(index, time))


def _length(vector: Array) -> float:
    return math.hypot(*vector)


def _active_rows(limits: Limits, solution: Solution) -> tuple[str, ...]:
    rows, contacts = limits.rows, limits.contact_rows
    names: list[str] = []
    if contacts is not None:
        push = contacts.force_matrix @ solution.force
        size = _ACTIVE * np.maximum(np.abs(push), 1.0)
        at_lower, at_upper = (
            push <= contacts.force_lower + size,
            push >= contacts.force_upper - size,
        )
        for k in np.flatnonzero(at_lower | at_upper):
            name = contacts.names[k]
            if at_lower[k]:
                names.append(f"{name}.lower")
            if at_upper[k]:
                names.append(f"{name}.upper" if k < contacts.bounds else name)
    if rows is not None:
        value = rows.values(solution.acceleration, solution.force)
        size = _ACTIVE * np.maximum(np.abs(value), 1.0)
        near = (value <= rows.lower + size) | (value >= rows.upper - size)
        names += [rows.names[k] for k in np.flatnonzero(near)]
    return tuple(_distinct(names))


def _box_slack(solution: Solution, box: Box) -> tuple[Slack, ...]:
    if solution.acceleration_slack is None:
        return ()
    return tuple(
        Slack(
            box.lower_name(entry)
            if solution.acceleration[entry] < box.bounds.lower[entry]
            else box.upper_name(entry),
            float(solution.acceleration_slack[entry]),
        )
        for entry in np.flatnonzero(solution.acceleration_slack > 0.0)
    )


def _rows_slack(limits: Limits, solution: Solution) -> tuple[Slack, ...]:
    slack: list[Slack] = []
    for rows, amounts in (
        (limits.rows, solution.rows_slack),
        (limits.contact_rows, solution.force_slack),
    ):
        if rows is not None and amounts is not None:
            places = np.flatnonzero(amounts > 0.0)
            slack += [Slack(rows.names[k], float(amounts[k])) for k in places]
    return tuple(slack)


def _fallback_reason(limits: Limits, solution: Solution) -> str:
    """Why there is no answer: rows in conflict by name, or what ended the QP."""
    if solution.reason and QpStatus.INFEASIBLE.value not in solution.reason:
        return f"no answer: {solution.reason}"
    return "no torque meets the hard rows: " + ", ".join(_conflicting(limits))


def _conflicting(limits: Limits) -> list[str]:
    """Names of the rows that bound torque or force from both sides: the suspects."""
    torque = limits.boxes.torque
    names = [torque.lower_name(i) for i in range(len(torque.entries))]
    names += [torque.upper_name(i) for i in range(len(torque.entries))]
    if limits.contact_rows is not None:
        names += limits.contact_rows.names
    return sorted({name for name in names if name})


def _distinct(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))

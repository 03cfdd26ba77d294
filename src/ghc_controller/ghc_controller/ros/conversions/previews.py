"""Plans of the constraint generators: from messages to values, and what is in force back."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from ghc_msgs.msg import ContactForceBounds, ObstacleState, ObstacleStateArray

from ghc_controller.contacts import ForceBoundsPlan, PlanStatus
from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.previews.motion_plan import MotionPlan, MotionStatus, PlannedObstacle
from ghc_controller.report.report import ObstacleReport
from ghc_controller.ros.time import nanoseconds_from_time
from ghc_controller.types import NANOSECONDS, UNIT_TOLERANCE, Array

Status = TypeVar("Status", PlanStatus, MotionStatus)

SHORTEST_STEP, LONGEST_STEP = 1e-6, 10.0  # [s] between two points of a plan
# What a planned obstacle may be at most, along one axis.
FARTHEST, FASTEST, SHARPEST, JERKIEST = 100.0, 20.0, 1e3, 1e6  # [m], [m/s], [m/s^2], [m/s^3]


def force_bounds_from_message(message: ContactForceBounds) -> ForceBoundsPlan:
    """Plan of a message.

    Raises:
        GhcError: sizes that do not fit together, entries that are not finite, a step out of
            range, an end before the start, an unknown status.
    """
    where, count = "contact_force_bounds", len(message.contacts)
    start, _ = _start_and_length(message)
    for name in ("in_contact", "conflict", "status"):
        if len(getattr(message, name)) != count:
            raise WrongSize(f"{where}, {name}", len(getattr(message, name)), count)
    return ForceBoundsPlan(
        start,
        _checked_step(message.step),
        tuple(message.contacts),
        _bounds(message, "lower"),
        _bounds(message, "upper"),
        tuple(message.in_contact),
        tuple(_status(PlanStatus, value, where) for value in message.status),
        tuple(message.conflict),
        message.interpolate,
    )


def obstacle_motion_from_message(message: ObstacleStateArray) -> MotionPlan:
    """Plan of a message.

    Raises:
        GhcError: sizes that do not fit, entries that are not finite, a step out of range, an end
            before the start, a normal that is not of unit length, an unknown status.
    """
    start, length = _start_and_length(message)
    step = _checked_step(message.step)
    steps = round(length / step)
    planned = tuple(_planned_obstacle(entry, steps) for entry in message.obstacles)
    return MotionPlan(start, step, steps, planned)


def _start_and_length(message: ContactForceBounds | ObstacleStateArray) -> tuple[float, float]:
    """Start and length [s] of a plan; InvalidValue when it ends before it starts."""
    start = nanoseconds_from_time(message.header.stamp)
    length = nanoseconds_from_time(message.valid_until) - start
    if length < 0:
        raise InvalidValue(
            f"valid_until {-length / NANOSECONDS:g} s before the stamp given, "
            "the stamp or later expected"
        )
    return start / NANOSECONDS, length / NANOSECONDS


def _checked_step(step: float) -> float:
    """The step [s] of a plan; InvalidValue when it is out of range or no number."""
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        raise InvalidValue(
            f"step {step:g} s given, {SHORTEST_STEP:g} to {LONGEST_STEP:g} s expected"
        )
    return step


def _bounds(message: ContactForceBounds, name: str) -> Array:
    """(c, p) [N] lower or upper bounds; GhcError for other sizes or what is not finite."""
    count, points = len(message.contacts), int(message.points)
    if points < 2:
        raise InvalidValue(f"contact_force_bounds, points: {points} given, 2 or more expected")
    values = np.array(getattr(message, name), dtype=np.float64)
    if values.shape != (count * points,):
        raise WrongSize(f"contact_force_bounds, {name}", len(values), f"{count} * {points}")
    if not np.isfinite(values).all():
        raise InvalidValue(f"contact_force_bounds, {name}: finite numbers expected")
    return values.reshape(count, points)


def _status(kind: type[Status], value: int, where: str) -> Status:
    """The status of that number; InvalidValue when there is none."""
    try:
        return kind(int(value))
    except ValueError as error:
        known = ", ".join(f"{status.value} ({status.name})" for status in kind)
        raise InvalidValue(f"{where}: status {value} given; known: {known}") from error


def _planned_obstacle(entry: ObstacleState, steps: int) -> PlannedObstacle:
    """One obstacle of a plan of so many steps; GhcError as in obstacle_motion_from_message."""
    where = f"obstacle '{entry.id}'"
    normal, state = np.array(entry.normal, dtype=np.float64), motion_state(entry)
    jerk = np.array(entry.jerk, dtype=np.float64)
    if len(jerk) % 3:
        raise WrongSize(f"{where}, jerk", len(jerk), "a multiple of 3")
    if len(jerk) > 3 * steps:
        raise WrongSize(f"{where}, jerk", len(jerk), f"at most 3 * {steps}")
    if not (np.isfinite(jerk).all() and np.isfinite(state).all()):
        raise InvalidValue(f"{where}: finite numbers expected")
    if not (math.isfinite(entry.safe_distance) and entry.safe_distance >= 0.0):
        raise InvalidValue(
            f"{where}: safe_distance {entry.safe_distance:g} m given, 0 or more expected"
        )
    for what, values, most in (
        ("position", state[0], FARTHEST),
        ("velocity", state[1], FASTEST),
        ("acceleration", state[2], SHARPEST),
        ("jerk", jerk, JERKIEST),
        ("safe_distance", np.array([entry.safe_distance]), FARTHEST),
    ):
        largest = float(np.abs(values).max(initial=0.0))
        if largest > most:
            raise InvalidValue(f"{where}, {what}: {largest:g} given, at most {most:g} expected")
    length = float(np.linalg.norm(normal))
    if not abs(length - 1.0) <= UNIT_TOLERANCE:  # as well when it is no number
        raise InvalidValue(f"{where}: normal of length {length:g} given, 1 expected")
    return PlannedObstacle(
        entry.id,
        entry.protected_frame,
        entry.safe_distance,
        normal,
        state,
        jerk.reshape(-1, 3),
        _status(MotionStatus, entry.status, where),
    )


def motion_state(entry: ObstacleState) -> Array:
    """(3, 3) rows: position, velocity, acceleration."""
    rows = [entry.position, entry.velocity, entry.acceleration]
    return np.array([list(row) for row in rows], dtype=np.float64)


def obstacle_message(report: ObstacleReport) -> ObstacleState:
    """A virtual obstacle as a control step used it; the jerk is left empty."""
    planned = report.planned
    entry = ObstacleState(id=planned.id, protected_frame=planned.frame)
    entry.safe_distance = float(planned.safe_distance)
    entry.normal[:] = planned.normal
    entry.position[:], entry.velocity[:], entry.acceleration[:] = report.state
    entry.status = planned.status.value
    return entry

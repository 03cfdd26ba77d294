"""Plans of the constraint generators: from messages to values, and what is in force back."""

from __future__ import annotations

import numpy as np
from ghc_msgs.msg import ContactForceBounds, ObstacleState, ObstacleStateArray
from rclpy.qos import QoSProfile, ReliabilityPolicy

from ghc_controller.constraints.motion_plan import MotionPlan, MotionStatus, PlannedObstacle
from ghc_controller.contacts import ForceBoundsPlan, PlanStatus
from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.report import ObstacleReport
from ghc_controller.ros_conversions import NANOSECONDS, nanoseconds_from_time
from ghc_controller.types import Array

PLAN_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE)


def force_bounds_from_message(message: ContactForceBounds) -> ForceBoundsPlan:
    """Plan of a message.

    Raises:
        GhcError: sizes that do not fit together, entries that are not finite.
    """
    count, points = len(message.contacts), int(message.points)
    for name in ("in_contact", "conflict", "status"):
        if len(getattr(message, name)) != count:
            raise WrongSize(f"contact_force_bounds, {name}", len(getattr(message, name)), count)
    bounds = {}
    for name in ("lower", "upper"):
        values = np.array(getattr(message, name), dtype=np.float64)
        if values.shape != (count * points,) or points < 2:
            raise WrongSize(f"contact_force_bounds, {name}", len(values), f"{count} * {points}")
        if not np.isfinite(values).all():
            raise InvalidValue(f"contact_force_bounds, {name}: finite numbers expected")
        bounds[name] = values.reshape(count, points)
    return ForceBoundsPlan(
        nanoseconds_from_time(message.header.stamp) / NANOSECONDS,
        message.step,
        tuple(message.contacts),
        bounds["lower"],
        bounds["upper"],
        tuple(message.in_contact),
        tuple(PlanStatus(int(value)) for value in message.status),
        tuple(message.conflict),
        message.interpolate,
    )


def obstacle_motion_from_message(message: ObstacleStateArray) -> MotionPlan:
    """Plan of a message.

    Raises:
        GhcError: sizes that do not fit, entries that are not finite.
    """
    start = nanoseconds_from_time(message.header.stamp)
    length = nanoseconds_from_time(message.valid_until) - start
    steps = round(length / NANOSECONDS / message.step) if message.step > 0.0 else 0
    planned = []
    for entry in message.obstacles:
        jerk = np.array(entry.jerk, dtype=np.float64)
        if len(jerk) % 3:
            raise WrongSize(f"obstacle '{entry.id}', jerk", len(jerk), "a multiple of 3")
        state = motion_state(entry)
        if not (np.isfinite(jerk).all() and np.isfinite(state).all()):
            raise InvalidValue(f"obstacle '{entry.id}': finite numbers expected")
        planned.append(
            PlannedObstacle(
                entry.id,
                entry.protected_frame,
                entry.safe_distance,
                np.array(entry.normal, dtype=np.float64),
                state,
                jerk.reshape(-1, 3),
                MotionStatus(int(entry.status)),
            )
        )
    return MotionPlan(start / NANOSECONDS, message.step, steps, tuple(planned))


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

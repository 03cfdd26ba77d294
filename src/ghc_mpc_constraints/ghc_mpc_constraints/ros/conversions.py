"""Between ROS messages and the generators' values: pure functions, both directions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import (
    ContactForceBounds,
    ContactSchedule,
    ControllerState,
    ObstacleState,
    ObstacleStateArray,
)
from rclpy.serialization import deserialize_message

from ghc_controller.contacts import ForceBoundsPlan
from ghc_controller.previews.motion_plan import MotionPlan, state_at
from ghc_controller.ros.conversions.common import doubles
from ghc_controller.ros.conversions.previews import motion_state
from ghc_controller.ros.time import nanoseconds_from_time, time_from_nanoseconds, time_from_seconds
from ghc_controller.types import NANOSECONDS, Array
from ghc_mpc_constraints.force_bounds.contact_schedule import ContactSchedule as Schedule
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.ros.schedule_inbox import TimedSchedule

LONGEST_GUESS = 0.1  # [s] over which motion in force is continued beyond what was heard


def schedule_from_message(
    message: ContactSchedule, known: Sequence[str], now: float
) -> TimedSchedule:
    """Schedule of a message; a zero stamp means that its times count from `now` [s].

    Raises:
        GhcError: see ContactSchedule.checked.
    """
    stamp = nanoseconds_from_time(message.header.stamp)
    known_from = nanoseconds_from_time(message.known_from)
    start = now if stamp == 0 else stamp / NANOSECONDS
    times = start + np.array(message.times, dtype=np.float64)
    schedule = Schedule.checked(
        message.contact, times.tolist(), message.lower, message.upper, known
    )
    return TimedSchedule(schedule, known_from / NANOSECONDS if known_from else None)


def schedule_message(schedule: Schedule, known_from: float = 0.0) -> ContactSchedule:
    """Message of a schedule with absolute times; the stamp is a nanosecond, as good as zero."""
    message = ContactSchedule(contact=schedule.contact)
    message.header.stamp = time_from_nanoseconds(1)
    message.known_from = time_from_seconds(known_from)
    message.times = doubles(schedule.times)
    message.lower = doubles(schedule.lower)
    message.upper = doubles(schedule.upper)
    return message


def force_bounds_message(plan: ForceBoundsPlan, start_ns: int, epoch: int) -> ContactForceBounds:
    """Message of a plan that starts at a tick [ns]."""
    steps = plan.lower.shape[1] - 1
    message = ContactForceBounds(step=plan.step, points=steps + 1, interpolate=plan.smoothed)
    message.header.stamp = time_from_nanoseconds(start_ns)
    message.epoch = epoch
    message.valid_until = time_from_nanoseconds(start_ns + round(steps * plan.step * NANOSECONDS))
    message.contacts = list(plan.contacts)
    message.lower = doubles(plan.lower)
    message.upper = doubles(plan.upper)
    message.in_contact = list(plan.in_contact)
    message.conflict = list(plan.conflict)
    message.status = [status.value for status in plan.status]
    return message


def measurement_from_message(message: ObstacleState) -> Measurement:
    """Measurement of a raw obstacle; GhcError as in Measurement.checked."""
    return Measurement.checked(
        message.id,
        message.protected_frame,
        list(message.position),
        list(message.normal),
        message.distance,
        message.safe_distance,
    )


def measurement_message(measurement: Measurement) -> ObstacleState:
    """Message of a measurement."""
    message = ObstacleState(id=measurement.id, protected_frame=measurement.frame)
    message.position[:] = measurement.position
    message.normal[:] = measurement.normal
    message.distance = float(measurement.distance)
    message.safe_distance = float(measurement.safe_distance)
    return message


def obstacle_motion_message(plan: MotionPlan, start_ns: int, epoch: int) -> ObstacleStateArray:
    """Message of a plan that starts at a tick [ns]."""
    message = ObstacleStateArray(step=plan.step)
    message.header.stamp = time_from_nanoseconds(start_ns)
    message.epoch = epoch
    end = start_ns + round(plan.steps * plan.step * NANOSECONDS)
    message.valid_until = time_from_nanoseconds(end)
    for planned in plan.obstacles:
        entry = ObstacleState(id=planned.id, protected_frame=planned.frame)
        entry.safe_distance = float(planned.safe_distance)
        entry.normal[:] = planned.normal
        entry.position[:], entry.velocity[:], entry.acceleration[:] = planned.state
        entry.jerk = doubles(planned.jerk)
        entry.status = planned.status.value
        message.obstacles.append(entry)
    return message


def bounds_in_force(states: Sequence[bytes], time: float) -> dict[str, tuple[float, float]]:
    """Contact -> (lower, upper) [N] at `time` [s] by the newest serialized ControllerStates.

    A bound that moves has moved on since the controller said it: of two states the second is
    continued at the rate between both.
    """
    stamps, bounds = zip(*(_stamped_bounds(data) for data in states), strict=True)
    ahead = _ahead(stamps[-1], time)
    newest = bounds[-1]
    if len(states) > 1 and stamps[-1] > stamps[0] and ahead > 0.0:
        share = ahead / (stamps[-1] - stamps[0])
        for contact in newest.keys() & bounds[0].keys():
            moved = newest[contact] + share * (newest[contact] - bounds[0][contact])
            newest[contact] = np.maximum(moved, 0.0)
    return {contact: (float(lower), float(upper)) for contact, (lower, upper) in newest.items()}


def motion_in_force(data: bytes, time: float) -> dict[str, Array]:
    """Obstacle -> state (3, 3) at `time` [s] by a serialized ControllerState, jerk zero since."""
    message: ControllerState = deserialize_message(data, ControllerState)
    ahead = _ahead(nanoseconds_from_time(message.header.stamp) / NANOSECONDS, time)
    still = np.zeros((1, 3))
    states = {entry.id: motion_state(entry) for entry in message.obstacles}
    return {
        name: state_at(state, still, 2.0 * ahead, ahead) if ahead > 0.0 else state
        for name, state in states.items()
    }


def _stamped_bounds(data: bytes) -> tuple[float, dict[str, Array]]:
    """Stamp [s], and contact -> (lower, upper) [N]."""
    message: ControllerState = deserialize_message(data, ControllerState)
    bounds = {
        contact.name: np.array([contact.lower, contact.upper])
        for contact in message.contacts
        if contact.planned
    }
    return nanoseconds_from_time(message.header.stamp) / NANOSECONDS, bounds


def _ahead(stamp: float, time: float) -> float:
    """How far [s] a state may be continued: what is older than that has said nothing for long."""
    return time - stamp if time - stamp < LONGEST_GUESS else 0.0

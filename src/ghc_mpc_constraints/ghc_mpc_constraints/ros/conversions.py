"""Conversions between ROS messages and values of the generators: pure functions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import (
    BoundInForce,
    ContactSchedule,
    ControllerState,
    LimitSchedule,
    ObstacleState,
    PlannedMotion,
)
from rclpy.serialization import deserialize_message

from ghc_controller.core.native import state_at
from ghc_controller.previews.motion import PlannedMotion as Motion
from ghc_controller.previews.preview import CONTACT_FORCES, OBSTACLE_MOTION, Preview
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.ros.conversions.common import doubles
from ghc_controller.ros.conversions.previews import motion_state
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.types import NANOSECONDS, Array
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule as Contact
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule as Schedule

LONGEST_GUESS = 0.1  # [s] over which the last received motion is extrapolated


def times_of(message: ContactSchedule | LimitSchedule, now: float) -> tuple[float, float | None]:
    """Time [s] to which those of a schedule are relative, and time from which it is known.

    A zero stamp means `now` [s]; without known_from it is known on receipt (None).
    """
    stamp = nanoseconds_from_time(message.header.stamp)
    known_from = nanoseconds_from_time(message.known_from)
    start = now if stamp == 0 else stamp / NANOSECONDS
    return start, known_from / NANOSECONDS if known_from else None


def schedule_message(
    schedule: Schedule, run_start: float = 0.0
) -> ContactSchedule | LimitSchedule:
    """Message of a schedule whose times count from `run_start` [s] of the robot's time."""
    message = (
        ContactSchedule(contact=schedule.name)
        if isinstance(schedule, Contact)
        else LimitSchedule(names=[schedule.name])
    )
    # One nanosecond instead of zero, since zero means: on receipt.
    message.header.stamp = time_from_seconds(max(run_start, 1e-9))
    if schedule.known_from:
        message.known_from = time_from_seconds(run_start + schedule.known_from)
    message.times = doubles(schedule.times)
    message.lower = doubles(schedule.lower)
    message.upper = doubles(schedule.upper)
    return message


def measurement_message(measurement: Measurement) -> ObstacleState:
    """Message of a measurement."""
    message = ObstacleState(id=measurement.id, protected_frame=measurement.frame)
    message.position[:] = measurement.position
    message.normal[:] = measurement.normal
    message.distance = float(measurement.distance)
    message.safe_distance = float(measurement.safe_distance)
    return message


def in_force(states: Sequence[bytes], time: float, kind: str) -> Preview:
    """Bounds and obstacles at `time` [s] from the newest one or two serialized ControllerStates.

    Moving bounds have changed since they were reported: with two states the second one is
    extrapolated at the rate between both. Obstacles are extrapolated with zero jerk.
    """
    messages = [deserialize_message(data, ControllerState) for data in states]
    if kind == OBSTACLE_MOTION:
        return _motions_in_force(messages[-1], time)
    stamps = [_stamp(message) for message in messages]
    bounds = [_bounds_of(message, kind) for message in messages]
    ahead, newest = _ahead(stamps[-1], time), bounds[-1]
    if len(states) > 1 and stamps[-1] > stamps[0] and ahead > 0.0:
        share = ahead / (stamps[-1] - stamps[0])
        for name in newest.keys() & bounds[0].keys():
            moved = newest[name] + share * (newest[name] - bounds[0][name])
            newest[name] = np.maximum(moved, 0.0) if kind == CONTACT_FORCES else moved
    values = np.array(list(newest.values())).reshape(-1, 2)
    lower, upper = (np.repeat(values[:, [side]], 2, axis=1) for side in (0, 1))
    count = len(newest)
    on, status = (True,) * count, (PreviewStatus.RAW,) * count
    return Preview(
        kind, time, 1.0, tuple(newest), lower, upper, on, status, (False,) * count, False
    )


def _motions_in_force(message: ControllerState, time: float) -> Preview:
    ahead = _ahead(_stamp(message), time)
    motions = tuple(_motion(entry, ahead) for entry in message.obstacles)
    return Preview.of_motions(time, 1.0, 1, motions)


def _motion(entry: PlannedMotion, ahead: float) -> Motion:
    """An obstacle extrapolated by `ahead` [s] with zero jerk."""
    state = motion_state(entry)
    if ahead > 0.0:
        state = state_at(state, np.zeros((1, 3)), 2.0 * ahead, ahead)
    normal, none = np.array(entry.normal), np.zeros((0, 3))
    frame, distance = entry.protected_frame, entry.safe_distance
    return Motion(entry.id, frame, distance, normal, state, none, PreviewStatus.RAW)


def _bounds_of(message: ControllerState, kind: str) -> dict[str, Array]:
    """Row -> (lower, upper) of one kind."""
    if kind != CONTACT_FORCES:
        entries: Sequence[BoundInForce] = message.bounds
        return {e.row: np.array([e.lower, e.upper]) for e in entries if e.kind == kind}
    return {c.name: np.array([c.lower, c.upper]) for c in message.contacts if c.planned}


def _stamp(message: ControllerState) -> float:
    return nanoseconds_from_time(message.header.stamp) / NANOSECONDS


def _ahead(stamp: float, time: float) -> float:
    """Time [s] over which a state may be extrapolated; older ones have timed out."""
    return time - stamp if time - stamp < LONGEST_GUESS else 0.0

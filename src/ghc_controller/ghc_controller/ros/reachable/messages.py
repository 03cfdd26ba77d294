"""Targets from messages, and references to messages."""

from __future__ import annotations

import numpy as np
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, PointStamped, PoseStamped, Quaternion
from ghc_msgs.msg import TaskReference, TaskReferencePoint

from ghc_controller.errors import ConfigurationError, InvalidValue
from ghc_controller.references.follower import Follower, ReferenceSpace
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.ros.conversions.common import doubles
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.types import NANOSECONDS, Array

_AXES = ("x", "y", "z")


def check_kind(task: Follower) -> None:
    """Raises ConfigurationError for a task whose targets are neither points nor orientations."""
    if task.space is ReferenceSpace.VECTOR and not set(task.labels) <= set(_AXES):
        raise ConfigurationError(
            f"tasks: '{task.name}' has the rows {', '.join(task.labels)}; a task of a position, "
            "an orientation or a pose expected"
        )


def stamp_of(message: PoseStamped | PointStamped) -> float | None:
    """[s], None where it is zero."""
    nanoseconds = nanoseconds_from_time(message.header.stamp)
    return nanoseconds / NANOSECONDS if nanoseconds else None


def target_of(message: PoseStamped | PointStamped, task: Follower) -> Array:
    """Reference position (position_size,) of a task.

    Raises:
        InvalidValue: the task needs an orientation and the message has none.
    """
    if isinstance(message, PointStamped):
        if task.space is not ReferenceSpace.VECTOR:
            raise InvalidValue(f"a point given, a pose expected by task '{task.name}'")
        return _coordinates(message.point, task)
    if task.space is ReferenceSpace.VECTOR:
        return _coordinates(message.pose.position, task)
    turn = _quaternion(message.pose.orientation)
    if task.space is ReferenceSpace.ORIENTATION:
        return turn
    position = message.pose.position
    return np.concatenate([[position.x, position.y, position.z], turn])


def reference_message(reference: ReferenceTrajectory) -> TaskReference:
    """Message of a trajectory with velocity and acceleration."""
    assert reference.velocity is not None
    assert reference.acceleration is not None
    message = TaskReference(task=reference.task)
    message.header.stamp = time_from_seconds(reference.start_time)
    for time, position, velocity, acceleration in zip(
        reference.times,
        reference.position,
        reference.velocity,
        reference.acceleration,
        strict=True,
    ):
        seconds, nanoseconds = divmod(round(time * NANOSECONDS), NANOSECONDS)
        message.points.append(
            TaskReferencePoint(
                time_from_start=Duration(sec=seconds, nanosec=nanoseconds),
                position=doubles(position),
                velocity=doubles(velocity),
                acceleration=doubles(acceleration),
            )
        )
    return message


def _coordinates(point: Point, task: Follower) -> Array:
    return np.array([getattr(point, axis) for axis in task.labels])


def _quaternion(q: Quaternion) -> Array:
    return np.array([q.x, q.y, q.z, q.w])

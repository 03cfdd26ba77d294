"""Requests to the controller and their status: transitions and references."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from ghc_msgs.msg import (
    PriorityTransition,
    TaskReference,
    TaskReferenceStatus,
    TransitionStatus,
)

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.hierarchy import (
    PriorityMatrix,
    Profile,
    Transition,
    TransitionEvent,
    format_hierarchy,
    matrix_from_hierarchy,
)
from ghc_controller.references.follower import Follower
from ghc_controller.references.progress import ReferenceEvent
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.ros.conversions.common import check_frame
from ghc_controller.ros.time import nanoseconds_from_time, time_from_seconds
from ghc_controller.tasks.posture import PostureTask
from ghc_controller.types import NANOSECONDS, Array

WORLD = "world"  # frame_id of targets; an empty one means the same


def transition_from_message(
    message: PriorityTransition, known_tasks: Sequence[str], now: float
) -> Transition:
    """Transition of a request; a zero stamp means `now` [s].

    Raises:
        GhcError: malformed string or matrix, unknown task, bad duration or profile.
    """
    if message.hierarchy and (len(message.tasks) or len(message.alpha)):
        raise InvalidValue(
            f"both hierarchy '{message.hierarchy}' and a matrix of {len(message.tasks)} tasks "
            "given, one of them expected"
        )
    if message.hierarchy:
        target = matrix_from_hierarchy(known_tasks, message.hierarchy)
    else:
        if not message.tasks:
            raise InvalidValue(
                "neither hierarchy nor tasks given; expected a hierarchy such as "
                f"'{' > '.join(known_tasks)}' or tasks with a row-major alpha"
            )
        target = PriorityMatrix.from_rows(known_tasks, message.tasks, message.alpha)
    stamp = nanoseconds_from_time(message.header.stamp)
    start = now if stamp == 0 else stamp / NANOSECONDS
    profile = Profile.parse(message.profile)
    return Transition(
        target,
        start,
        message.duration,
        profile,
        message.id,
        message.hierarchy,
        message.torque_rate,
    )


def status_message(
    status: int, time: float, transition: Transition | None, request_id: str = "", reason: str = ""
) -> TransitionStatus:
    """Status of a transition; None: the request was never accepted."""
    message = TransitionStatus(status=status, id=request_id, reason=reason)
    message.header.stamp = time_from_seconds(time)
    if transition is not None:
        message.id = transition.id
        message.hierarchy = transition.hierarchy or format_hierarchy(transition.target)
        message.start = time_from_seconds(transition.start)
        message.duration = transition.duration
        message.torque_rate = transition.torque_rate
    return message


def event_message(event: TransitionEvent) -> TransitionStatus:
    """Status message of an event of an accepted transition."""
    return status_message(
        getattr(TransitionStatus, event.phase.value), event.time, event.transition
    )


def reference_status_message(
    status: int, time: float, request: TaskReference, start: float = 0.0, reason: str = ""
) -> TaskReferenceStatus:
    """Reply to a reference; `start` and `time` in [s]."""
    message = TaskReferenceStatus(status=status, id=request.id, task=request.task, reason=reason)
    message.header.stamp = time_from_seconds(time)
    message.start = time_from_seconds(start)
    return message


def reference_event_message(event: ReferenceEvent) -> TaskReferenceStatus:
    """Status message of the end of an accepted reference."""
    return reference_status_message(
        getattr(TaskReferenceStatus, event.phase.value),
        event.time,
        TaskReference(id=event.id, task=event.task),
        event.start,
        event.reason,
    )


def reference_from_message(
    message: TaskReference, task: Follower, current: Array, now: float
) -> ReferenceTrajectory:
    """Reference of a task; a zero stamp means `now` [s].

    Args:
        current: current target position, kept by points that give none.

    Raises:
        GhcError: sizes, values or joint names that do not fit the task.
    """
    check_frame(message.header.frame_id, WORLD)
    if not message.points:
        raise InvalidValue(f"task '{task.name}': no points given, at least one expected")
    order = _joint_order(message, task)
    times = [
        point.time_from_start.sec + point.time_from_start.nanosec / NANOSECONDS
        for point in message.points
    ]
    position = [
        current if not point.position else _row(task, "position", point.position, order)
        for point in message.points
    ]
    if len(message.points) == 1:
        _check_at_rest(message, task)
    stamp = nanoseconds_from_time(message.header.stamp)
    return ReferenceTrajectory.for_task(
        task,
        np.array(times),
        np.array(position),
        _optional_rows(message, task, "velocity", order),
        _optional_rows(message, task, "acceleration", order),
        _optional_rows(message, task, "wrench", order),
        now if stamp == 0 else stamp / NANOSECONDS,
    )


def _check_at_rest(message: TaskReference, task: Follower) -> None:
    """Reject the velocity of a single point: without a second one nothing moves at it."""
    for name in ("velocity", "acceleration"):
        values = getattr(message.points[0], name)
        if any(values):
            raise InvalidValue(
                f"task '{task.name}', {name}: {[float(value) for value in values]} given for one "
                "point, zeros or none expected: the target stays there. Two points make a motion, "
                "and reachable_targets makes one of a stream of poses"
            )


def _joint_order(message: TaskReference, task: Follower) -> list[int] | None:
    """Index of each joint of the task in the message; None when it names none."""
    if not message.joints:
        return None
    if not isinstance(task, PostureTask):
        raise InvalidValue(f"task '{task.name}' has no joints; joints is for posture tasks only")
    if sorted(message.joints) != sorted(task.labels):
        raise InvalidValue(
            f"task '{task.name}': joints {', '.join(message.joints)} given, "
            f"{', '.join(task.labels)} in any order expected"
        )
    return [list(message.joints).index(joint) for joint in task.labels]


def _row(task: Follower, name: str, values: Sequence[float], order: list[int] | None) -> Array:
    row = np.array(values, dtype=np.float64)
    expected = task.position_size if name == "position" else task.reference_size
    if row.shape != (expected,):
        raise WrongSize(f"task '{task.name}', {name} of a point", len(row), expected)
    return row if order is None else row[order]


def _optional_rows(
    message: TaskReference, task: Follower, name: str, order: list[int] | None
) -> Array | None:
    """(p, m) when any point gives the field, zeros where a point does not; else None."""
    values = [getattr(point, name) for point in message.points]
    if not any(len(value) for value in values):
        return None
    zero = [0.0] * task.reference_size
    return np.array([_row(task, name, value or zero, order) for value in values])

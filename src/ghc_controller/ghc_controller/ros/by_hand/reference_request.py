"""A reference sent from the command line, followed until it is reached or rejected."""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
from builtin_interfaces.msg import Time
from ghc_msgs.msg import (
    ControllerState,
    TaskReference,
    TaskReferencePoint,
    TaskReferenceStatus,
    TaskState,
)
from rclpy.node import Node

from ghc_controller.errors import ConfigurationError, UnknownName
from ghc_controller.references.point_files import Points
from ghc_controller.ros.by_hand.follow import line
from ghc_controller.ros.by_hand.move import Move, rows_of
from ghc_controller.ros.qos import RELIABLE_QOS, STREAM_QOS
from ghc_controller.ros.requests import REFERENCE
from ghc_controller.ros.run import EXIT_FAILED
from ghc_controller.ros.time import seconds_from_time, time_from_seconds
from ghc_controller.types import Array

NODE_NAME = "reference"
_ENDS = {TaskReferenceStatus.REJECTED: "REJECTED", TaskReferenceStatus.REPLACED: "REPLACED"}
_SAME = 1e-3  # [m], [rad] or [-] references closer than this are equal


class ReferenceRequest:
    """One reference and the reported status of its task."""

    def __init__(
        self,
        task: str,
        path: Move | Points,
        start: float,
        tolerance: float,
        show: Callable[[str], None],
    ) -> None:
        """`start` [s] of the robot's time, 0 = at once; `tolerance` [m] or [rad]."""
        self.node = Node(NODE_NAME)
        self.exit_code: int | None = None  # None while it is pending
        self._task, self._path, self._start = task, path, start
        self._tolerance = tolerance
        self._show = show
        self._sent_at: float | None = None  # [s] of the robot
        self._id = f"{NODE_NAME}_{os.getpid()}"
        self._target = np.zeros(0)
        self._any_order = False  # the target's numbers belong to named joints, in any order
        self._end = 0.0  # [s] of the robot, at the last point
        self._last: TaskState | None = None
        self._state: ControllerState | None = None
        self._publisher = self.node.create_publisher(TaskReference, REFERENCE, RELIABLE_QOS)
        self.node.create_subscription(
            TaskReferenceStatus, "ghc/task_reference_status", self._on_status, RELIABLE_QOS
        )
        # Created last: once a report arrives, the controller has found the publisher above.
        self.node.create_subscription(
            ControllerState, "ghc/controller_state", self._on_state, STREAM_QOS
        )

    def send_when_heard(self) -> None:
        """Send it once, when a controller can receive it and reports."""
        state = self._state
        if self._sent_at is not None or state is None or self.exit_code is not None:
            return
        if self._publisher.get_subscription_count() == 0:
            return
        stamp = state.header.stamp
        known = {task.name: task for task in state.tasks}
        if self._task not in known:
            self._finish(stamp, "REJECTED", str(UnknownName("task", self._task, known)))
            return
        present = known[self._task]
        self._show(line(stamp, "current", describe(present)))
        try:
            points = (
                self._path.points_from(present) if isinstance(self._path, Move) else self._path
            )
        except ConfigurationError as error:
            self._finish(stamp, "REJECTED", str(error))
            return
        self._sent_at = seconds_from_time(stamp)
        self._end = max(self._start, self._sent_at) + points.end
        last = np.array(points.points[-1].position)
        self._target = last if last.size else np.array(present.reference)
        self._any_order = bool(points.joints)
        message = reference_message(self._task, points, self._start)
        message.id = self._id
        self._publisher.publish(message)
        over = f" over {points.end:g} s" if points.end else ""
        begin = f" from t = {self._start:.3f} s" if self._start else ""
        self._show(line(stamp, "SENT", f"{self._task} to {_numbers(last)}{begin}{over}"))

    def missing(self) -> str:
        """What has not happened yet."""
        if self._sent_at is None:
            return "no ghc/controller_state: no controller, or one without joint_states,"
        error = "" if self._last is None else f", error {self._last.error_norm:.2g},"
        return f"'{self._task}' did not reach its reference{error}"

    def _on_state(self, message: ControllerState) -> None:
        self._state = message
        if self._sent_at is None or self.exit_code is not None:
            return
        now = seconds_from_time(message.header.stamp)
        task = next((task for task in message.tasks if task.name == self._task), None)
        if task is None:
            return
        self._last = task
        turns = rows_of(task) < len(task.reference)
        followed = same_target(np.array(task.reference), self._target, turns, self._any_order)
        if now >= self._end and followed and task.error_norm <= self._tolerance:
            self._finish(message.header.stamp, "REACHED", describe(task), 0)

    def _on_status(self, message: TaskReferenceStatus) -> None:
        if message.id == self._id and message.status in _ENDS and self.exit_code is None:
            self._finish(message.header.stamp, _ENDS[message.status], message.reason)

    def _finish(self, stamp: Time, word: str, detail: str, code: int = EXIT_FAILED) -> None:
        self._show(line(stamp, word, detail))
        self.exit_code = code


def describe(task: TaskState) -> str:
    """Current reference of a task and the error of the robot."""
    return f"{task.name} at {_numbers(np.array(task.reference))}, error {task.error_norm:.2g}"


def same_target(a: Array, b: Array, turns: bool = False, any_order: bool = False) -> bool:
    """Whether two references are equal.

    Args:
        turns: whether the last four numbers are a quaternion, which equals its negative.
        any_order: whether the numbers may be in any order, as those of named joints.
    """
    if a.shape != b.shape:
        return False
    pairs = [(a, b)]
    if turns:
        pairs.append((np.concatenate([a[:-4], -a[-4:]]), b))
    if any_order:
        pairs.append((np.sort(a), np.sort(b)))
    return any(bool(np.abs(one - other).max(initial=0.0) <= _SAME) for one, other in pairs)


def reference_message(task: str, points: Points, start: float) -> TaskReference:
    """Message of a path that starts at `start` [s] of the robot's time; 0 = at once."""
    message = TaskReference(task=task, joints=list(points.joints))
    message.header.stamp = time_from_seconds(start)
    for point in points.points:
        entry = TaskReferencePoint(
            position=list(point.position),
            velocity=list(point.velocity),
            acceleration=list(point.acceleration),
            wrench=list(point.wrench),
        )
        after = time_from_seconds(point.time)
        entry.time_from_start.sec, entry.time_from_start.nanosec = after.sec, after.nanosec
        message.points.append(entry)
    return message


def _numbers(values: Array) -> str:
    return " ".join(f"{value:.4g}" for value in values)

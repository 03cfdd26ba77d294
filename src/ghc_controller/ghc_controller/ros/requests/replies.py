"""Replies to requests, and the status of those that were accepted.

Publishes  ghc/transition_status, ghc/task_reference_status.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from ghc_msgs.msg import TaskReference, TaskReferenceStatus, TransitionStatus
from rclpy.node import Node

from ghc_controller.hierarchy import Transition, TransitionEvent
from ghc_controller.references.progress import ReferenceEvent
from ghc_controller.ros.conversions.requests import (
    event_message,
    reference_event_message,
    reference_status_message,
    status_message,
)
from ghc_controller.ros.qos import RELIABLE_QOS
from ghc_controller.ros.requests.topics import TRANSITION

_MOST_NAME, _MOST_WORDS = 200, 1000  # [-] characters of the id and the reason in a reply


class Replies:
    """Publishes what becomes of requests."""

    def __init__(self, node: Node, reject: Callable[[str, str], object]) -> None:
        """`reject` is called with the topic and the reason of each rejection."""
        self._reject = reject
        self._transitions = node.create_publisher(
            TransitionStatus, "ghc/transition_status", RELIABLE_QOS
        )
        self._references = node.create_publisher(
            TaskReferenceStatus, "ghc/task_reference_status", RELIABLE_QOS
        )

    def transition_events(self, events: Iterable[TransitionEvent]) -> None:
        """Publish what happened to accepted transitions."""
        for event in events:
            self._transitions.publish(event_message(event))

    def reference_events(self, events: Iterable[ReferenceEvent]) -> None:
        """Publish the ends of accepted references."""
        for event in events:
            self._references.publish(reference_event_message(event))

    def repeated(self, transition: Transition, is_settled: bool, now: float) -> None:
        """Accept a repetition; DONE follows at once only if the ramp has ended."""
        self._transitions.publish(status_message(TransitionStatus.ACCEPTED, now, transition))
        if is_settled:
            self._transitions.publish(status_message(TransitionStatus.DONE, now, transition))

    def accepted_reference(self, message: TaskReference, start: float, now: float) -> None:
        """Accept a reference that begins at `start` [s]."""
        self._references.publish(
            reference_status_message(TaskReferenceStatus.ACCEPTED, now, message, start)
        )

    def rejected(self, topic: str, message: Any, reason: str, now: float) -> None:
        """Reply to a rejected request; `message` is None if it cannot be read."""
        reason = reason[:_MOST_WORDS]
        name = "" if message is None else message.id[:_MOST_NAME]
        if topic == TRANSITION:
            status = TransitionStatus.REJECTED
            self._transitions.publish(status_message(status, now, None, name, reason))
        else:
            task = "" if message is None else message.task[:_MOST_NAME]
            request = TaskReference(id=name, task=task)
            status = TaskReferenceStatus.REJECTED
            self._references.publish(reference_status_message(status, now, request, reason=reason))
        self._reject(topic, reason)

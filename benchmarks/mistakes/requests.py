"""Mistakes in messages to the controller: references and transitions, and the replies."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from ghc_msgs.msg import (
    PriorityTransition,
    TaskReference,
    TaskReferencePoint,
    TaskReferenceStatus,
    TransitionStatus,
)
from rclpy.serialization import serialize_message

import ghc_controller as ghc
from benchmarks.mistakes.mistake import Mistake
from ghc_controller.ros.requests import RequestSubscriber
from ghc_controller.ros.time import time_from_seconds
from ghc_controller.safety.modes import Arming, ModeLogic
from ghc_sim_bridge import Simulator

_REJECTED = (TransitionStatus.REJECTED, TaskReferenceStatus.REJECTED)


class Desk:
    """What receives requests in the controller node; in lockstep it answers at once."""

    def __init__(self, lockstep: bool = True) -> None:
        """With the robot of the demo, at its first state."""
        controller = ghc.Controller.for_robot("kuka_lwr")
        modes = ModeLogic(Arming.AUTOMATIC, lambda: None)
        modes.started()
        controller.observe(Simulator("kuka_lwr").state())
        self._callbacks: dict[type, Callable[[bytes], None]] = {}
        self.replies: list[Any] = []
        self.subscriber = RequestSubscriber(self, controller, modes, lockstep, self, self._reject)
        self.subscriber.at(0.0)

    def send(self, message: Any) -> str:
        """Reasons of the replies that reject a message, "" if it is accepted."""
        self.replies.clear()
        self._callbacks[type(message)](serialize_message(message))
        return "; ".join(reply.reason for reply in self.replies if reply.status in _REJECTED)

    def create_publisher(self, *_: Any) -> Any:
        """A publisher whose messages are kept."""
        return _Replies(self.replies)

    def create_subscription(self, kind: type, _topic: str, call: Any, *_: Any, **__: Any) -> None:
        """Keep the callback."""
        self._callbacks[kind] = call

    def forget(self) -> None:
        """The state need not be computed again."""

    def is_stale(self, _stamp: int) -> bool:
        """One run only."""
        return False

    def is_of_next_run(self, _stamp: int) -> bool:
        """One run only."""
        return False

    def _reject(self, _field: str, _reason: str) -> None:
        """The warning in the log has the text of the reply."""


class _Replies:
    """A publisher that keeps what it is given."""

    def __init__(self, replies: list[Any]) -> None:
        self.publish = replies.append


@cache
def desk() -> Desk:
    """One for all mistakes: a rejected request changes nothing."""
    return Desk()


def _point(*position: float, time: float = 0.0, **fields: Any) -> TaskReferencePoint:
    return TaskReferencePoint(position=list(position), time_from_start=_duration(time), **fields)


def _duration(seconds: float) -> Any:
    from builtin_interfaces.msg import Duration

    stamp = time_from_seconds(seconds)
    return Duration(sec=stamp.sec, nanosec=stamp.nanosec)


def _reference(task: str, *points: TaskReferencePoint, frame: str = "") -> TaskReference:
    message = TaskReference(task=task, points=list(points))
    message.header.frame_id = frame
    return message


def _sent(*messages: Any) -> Callable[[Path], str]:
    return lambda _: " / ".join(desk().send(message) for message in messages)


def _transition(**fields: Any) -> PriorityTransition:
    return PriorityTransition(**fields)


_HAND = "end_effector"
_NEAR = (0.45, 0.1, 0.7)
_ORDER = "elbow > end_effector > posture"

REQUESTS = (
    Mistake(
        29,
        "references to an unknown task, with two or seven numbers, NaN, no points, equal times",
        (
            "unknown task 'hnad'; known: end_effector, elbow, posture",
            "size 2 given, 3 expected",
            "size 7 given, 3 expected",
            "nan",
            "no points given",
            "increasing times expected",
        ),
        _sent(
            _reference("hnad", _point(*_NEAR)),
            _reference(_HAND, _point(0.4, 0.1)),
            _reference(_HAND, _point(*_NEAR, 0.0, 0.0, 0.0, 1.0)),
            _reference(_HAND, _point(0.4, math.nan, 0.7)),
            _reference(_HAND),
            _reference(_HAND, _point(*_NEAR), _point(*_NEAR)),
        ),
    ),
    Mistake(
        30,
        "a reference in millimeters (450, 100, 700)",
        (f"task '{_HAND}'", "position", "700 given", "at most 10", "expected"),
        _sent(_reference(_HAND, _point(450.0, 100.0, 700.0))),
    ),
    Mistake(
        31,
        "the reference of a posture in degrees",
        ("task 'posture'", "rad given for 'joint_", "rad expected"),
        _sent(_reference("posture", _point(0.0, 45.0, 0.0, -90.0, 0.0, 30.0, 0.0))),
    ),
    Mistake(
        32,
        "a reference in the axes of the tool (`frame_id: tool`)",
        ("frame_id 'tool' given", "expected", "world"),
        _sent(_reference(_HAND, _point(*_NEAR), frame="tool")),
    ),
    Mistake(
        33,
        "one point with a velocity",
        (f"task '{_HAND}'", "velocity", "one point", "expected"),
        _sent(_reference(_HAND, _point(*_NEAR, velocity=[0.1, 0.0, 0.0]))),
    ),
    Mistake(
        34,
        "transitions with duration -1, empty, of a wrong size, alpha 2, a task twice, an unknown "
        "profile",
        (
            "duration",
            "-1",
            "neither hierarchy nor tasks given",
            "size 3 given",
            "[0, 1]",
            "more than once",
            "unknown profile 'jerky'; known: ",
        ),
        _sent(
            _transition(hierarchy=_ORDER, duration=-1.0),
            _transition(),
            _transition(tasks=[_HAND, "elbow"], alpha=[0.0, 0.0, 1.0]),
            _transition(tasks=[_HAND, "elbow"], alpha=[0.0, 2.0, 0.0, 0.0]),
            _transition(hierarchy=f"{_HAND} > {_HAND}"),
            _transition(hierarchy=_ORDER, profile="jerky"),
        ),
    ),
)

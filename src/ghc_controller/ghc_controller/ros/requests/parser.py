"""From a serialized request to a checked value: a transition or a reference."""

from __future__ import annotations

from typing import Any

import numpy as np
from ghc_msgs.msg import PriorityTransition
from rclpy.serialization import deserialize_message

from ghc_controller.controller import Controller
from ghc_controller.hierarchy import Transition
from ghc_controller.references.plausibility import check_plausible
from ghc_controller.references.reference import ReferenceTrajectory
from ghc_controller.ros.conversions.requests import reference_from_message, transition_from_message
from ghc_controller.ros.requests.topics import KINDS


class RequestParser:
    """Parses and checks requests for one controller, without applying them."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller

    @staticmethod
    def message(topic: str, data: bytes) -> Any:
        """The message of a topic; an exception of the middleware if it cannot be read."""
        return deserialize_message(data, KINDS[topic])

    def value(self, message: Any, now: float) -> Transition | ReferenceTrajectory:
        """The request as a value at the time `now` [s].

        Raises:
            GhcError: an unknown task, wrong sizes, a value that is implausible for the robot.
        """
        controller = self._controller
        if isinstance(message, PriorityTransition):
            return transition_from_message(message, controller.robot.task_names, now)
        schedule = controller.schedule_of(message.task)
        task = schedule.task(message.task)
        current = np.zeros(task.position_size)  # of points that give no position
        if not all(len(point.position) for point in message.points):
            current = schedule.peek(message.task, now).position
        reference = reference_from_message(message, task, current, now)
        check_plausible(task, reference, controller.model.limits, controller.model.joint_names)
        return reference

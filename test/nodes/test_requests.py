"""Requests between a hold and the next state, when nothing is followed: taken, or refused so."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ghc_msgs.msg import TaskReference, TaskReferencePoint, TaskReferenceStatus
from rclpy.serialization import serialize_message

import ghc_controller as ghc
from ghc_controller.ros.requests import REFERENCE, RequestSubscriber
from ghc_controller.safety.modes import Arming, Mode, ModeLogic
from ghc_controller.types import RobotState

POSITION = [0.5, 0.1, 0.7]  # [m]


class Desk:
    """A controller that has made a step, and its requests without a node."""

    def __init__(self) -> None:
        self.controller = ghc.Controller.for_robot("kuka_lwr")
        self.replies: list[TaskReferenceStatus] = []
        self.modes = ModeLogic(Arming.REQUEST, self._on_change)
        node: Any = SimpleNamespace(
            create_publisher=lambda *_: SimpleNamespace(publish=self.replies.append),
            create_subscription=lambda *_, **__: None,
        )
        states: Any = SimpleNamespace(
            forget=lambda: None, is_stale=lambda _: False, is_of_next_run=lambda _: False
        )
        self.requests = RequestSubscriber(
            node, self.controller, self.modes, True, states, lambda *_: None
        )
        self.state = RobotState(0.0, np.full(7, 0.3), np.zeros(7))
        self.controller.observe(self.state)
        self.modes.started()
        self.requests.at(0.0)

    def _on_change(self) -> None:
        if self.modes.mode is Mode.ACTIVE:
            self.controller.activate()
        else:
            self.controller.hold()

    def ask(self, position: list[float]) -> TaskReferenceStatus:
        """The reply to a reference of the end effector."""
        message = TaskReference(id="me", task="end_effector")
        message.points = [TaskReferencePoint(position=position)]
        self.requests._take(REFERENCE, serialize_message(message))
        return self.replies[-1]


@pytest.mark.parametrize("position", [POSITION, []])
def test_a_latched_controller_says_that_it_is(position: list[float]) -> None:
    desk = Desk()
    desk.modes.fault("a test")
    reply = desk.ask(position)
    assert reply.status == TaskReferenceStatus.REJECTED
    assert reply.reason.startswith("the controller is latched (a test")


def test_a_held_one_takes_a_position_and_refuses_to_guess_one() -> None:
    desk = Desk()
    refused = desk.ask([])
    assert (refused.id, refused.status) == ("me", TaskReferenceStatus.REJECTED)
    assert "no reference is in force before the next state" in refused.reason
    assert desk.ask(POSITION).status == TaskReferenceStatus.ACCEPTED
    assert desk.modes.mode is Mode.ACTIVE
    assert np.isfinite(desk.controller.step(desk.state).torque).all()

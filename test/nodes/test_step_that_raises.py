"""A mistake in a control step is a latched fault, and the robot is braked from that state on."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ghc_controller as ghc
from ghc_controller.ros.controller_node import ControllerNode
from ghc_controller.ros.wire.joint_state import JointStateEncoder, JointStateValues
from ghc_controller.ros.wire.joint_state_reader import JointStateReader
from ghc_controller.safety.modes import Arming, Mode, ModeLogic
from ghc_controller.types import RobotState


def test_the_state_of_a_step_that_raises_is_answered_by_braking(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    controller = ghc.Controller.for_robot("kuka_lwr")
    names, q, v = controller.model.joint_names, np.full(7, 0.3), np.full(7, 0.2)
    expected = ghc.Controller.for_robot("kuka_lwr").brake(RobotState(1.0, q, v))
    logic, sent = ModeLogic(Arming.REQUEST, lambda: None), list[bytes]()
    logic.started()
    node: Any = ControllerNode.__new__(ControllerNode)
    node._controller, node._reader = controller, JointStateReader(names)
    node._encoder, node._mirror = JointStateEncoder(names, "", motion=False), None
    node._commands = SimpleNamespace(publish=sent.append)
    node._parameters = SimpleNamespace(lockstep=True)
    node._modes = SimpleNamespace(mode=Mode.ACTIVE, logic=logic)
    node._requests = SimpleNamespace(is_open=True, at=lambda _: None)
    node._previews = SimpleNamespace(hand_over=lambda *_: None)
    node._tuning = SimpleNamespace(at_state=lambda: None)
    node._states = SimpleNamespace(
        epoch=0, companions=lambda _: ({}, None), answered=lambda _: None
    )

    def mistake(_: RobotState) -> None:
        raise ZeroDivisionError("a mistake")

    monkeypatch.setattr(controller, "step", mistake)
    none = np.zeros(0)
    node.answer(JointStateValues(10**9, "", names, q, v, none), new_epoch=False)
    assert (logic.mode, "a step raised ZeroDivisionError" in logic.reason) == (Mode.LATCHED, True)
    (command,) = sent
    assert command == JointStateEncoder(names, "", motion=False).encode(10**9, expected)

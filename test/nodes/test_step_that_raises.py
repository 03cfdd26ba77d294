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


def _node(controller: ghc.Controller, logic: ModeLogic, sent: list[bytes]) -> Any:
    """A node without topics, whose mode is that of `logic`."""
    names = controller.model.joint_names
    node: Any = ControllerNode.__new__(ControllerNode)
    node._controller, node._reader = controller, JointStateReader(names)
    node._encoder, node._mirror = JointStateEncoder(names, "", motion=False), None
    node._commands = SimpleNamespace(publish=sent.append)
    node._parameters = SimpleNamespace(lockstep=True)
    node._modes = SimpleNamespace(
        logic=logic, begin=lambda _: logic.started(), stepped=lambda *_: None
    )
    logic._changed = lambda: setattr(node._modes, "mode", logic.mode)
    node._modes.mode, node._resets = logic.mode, False
    node._requests = SimpleNamespace(
        is_open=True, at=lambda _: None, begin_run=lambda: None, tell=lambda _: None
    )
    node._previews = SimpleNamespace(hand_over=lambda *_: None, forget=lambda: None)
    node._status = SimpleNamespace(reset=lambda: None, publish=lambda *_: None)
    node._plausibility = SimpleNamespace(reset=lambda: None)
    node._states = SimpleNamespace(
        epoch=0, companions=lambda _: ({}, None), answered=lambda _: None
    )
    return node


@pytest.mark.parametrize("method", ["step", "observe", "reset"])
def test_the_state_of_a_mistake_is_answered_by_braking(
    monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    """Of a plug-in: in a step, or where a run begins."""
    controller = ghc.Controller.for_robot("kuka_lwr")
    names, q, v = controller.model.joint_names, np.full(7, 0.3), np.full(7, 0.2)
    expected = ghc.Controller.for_robot("kuka_lwr").brake(RobotState(1.0, q, v))
    logic, sent = ModeLogic(Arming.REQUEST, lambda: None), list[bytes]()
    logic.started()
    node = _node(controller, logic, sent)

    def mistake(*_: RobotState) -> None:
        raise ZeroDivisionError("a mistake")

    first = JointStateValues(10**9, "", names, q, v, np.zeros(0))
    with monkeypatch.context() as patch:
        patch.setattr(controller, method, mistake)
        node.answer(first, new_epoch=method != "step")
    named = "a step raised" if method == "step" else "the beginning of a run raised"
    assert logic.mode is Mode.LATCHED
    assert f"{named} ZeroDivisionError: a mistake" in logic.reason
    (command,) = sent
    assert command == JointStateEncoder(names, "", motion=False).encode(10**9, expected)


def test_a_reset_that_raised_is_due_until_it_has_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """A controller that is half reset takes no step, also after the fault was reset."""
    controller = ghc.Controller.for_robot("kuka_lwr")
    names, q = controller.model.joint_names, np.full(7, 0.3)
    logic, sent = ModeLogic(Arming.REQUEST, lambda: None), list[bytes]()
    node = _node(controller, logic, sent)
    calls: list[str] = []

    def mistake() -> None:
        calls.append("reset")
        raise ZeroDivisionError("a mistake")

    def values(stamp_ns: int) -> JointStateValues:
        return JointStateValues(stamp_ns, "", names, q, np.zeros(7), np.zeros(0))

    with monkeypatch.context() as patch:
        patch.setattr(controller, "reset", mistake)
        node.answer(values(10**9), new_epoch=True)
        logic.reset_fault()
        node.answer(values(10**9 + 10**6), new_epoch=False)
        assert (calls, logic.mode) == (["reset", "reset"], Mode.LATCHED)
    logic.reset_fault()
    node.answer(values(10**9 + 2 * 10**6), new_epoch=False)
    assert (len(calls), logic.mode, len(sent)) == (2, Mode.HOLDING, 3)
    assert not node._resets


def test_a_run_whose_first_request_raises_has_begun() -> None:
    """What was sent ahead for it is taken, and references of the run before have ended."""
    controller = ghc.Controller.for_robot("kuka_lwr")
    logic, sent, begun = ModeLogic(Arming.REQUEST, lambda: None), list[bytes](), list[str]()
    node = _node(controller, logic, sent)

    def mistake(_: float) -> None:
        raise ZeroDivisionError("a mistake")

    node._requests.at, node._requests.begin_run = mistake, lambda: begun.append("run")
    names, q = controller.model.joint_names, np.full(7, 0.3)
    node.answer(JointStateValues(10**9, "", names, q, np.zeros(7), np.zeros(0)), new_epoch=True)
    assert (begun, logic.mode, len(sent)) == (["run"], Mode.LATCHED, 1)

"""What a task of another package raises for a request is told, and ends no node."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import pytest
from ghc_msgs.msg import TaskReference, TaskReferencePoint

from benchmarks.mistakes.requests import Desk
from ghc_controller.ros.controller_node import ControllerNode
from ghc_controller.safety.modes import Arming, Mode, ModeLogic

PATIENCE = 60.0  # [s] wall


def _mistake(*_: Any) -> None:
    raise ZeroDivisionError("a mistake")


def _waiting(desk: Desk) -> None:
    """Send a reference that waits for a state."""
    point = TaskReferencePoint(position=[0.4, 0.0, 0.5])
    desk.send(TaskReference(id="here", task="elbow", points=[point]))
    deadline = time.monotonic() + PATIENCE
    while not desk.subscriber._queue._ready and time.monotonic() < deadline:
        time.sleep(0.01)


def _node(desk: Desk, logic: ModeLogic, told: list[tuple[str, ...]]) -> Any:
    """A node without topics that no state has reached for a while."""
    node: Any = ControllerNode.__new__(ControllerNode)
    node._requests, node._answered_at = desk.subscriber, 0.0
    node._modes = SimpleNamespace(logic=logic)
    node._reject = lambda *words: told.append(words)
    return node


def test_one_that_cannot_be_read_at_the_first_state_is_refused() -> None:
    """It is checked there, as the thread checks later ones."""
    desk = Desk(lockstep=False)
    desk.subscriber._queue.now = None  # no state yet
    desk.subscriber._parser.value = _mistake  # type: ignore[method-assign, assignment]
    _waiting(desk)
    desk.subscriber.at(0.5)
    desk.subscriber.close()
    assert [(reply.id, reply.reason) for reply in desk.replies] == [("here", "a mistake")]


@pytest.mark.parametrize("arming", [Arming.REQUEST, Arming.AUTOMATIC])
def test_one_that_cannot_be_applied_between_states_is_a_fault(arming: Arming) -> None:
    """As in a step: latched where faults are. The sender is told in any case."""
    desk = Desk(lockstep=False)
    logic, told = ModeLogic(arming, lambda: None), list[tuple[str, ...]]()
    logic.started()
    _waiting(desk)
    desk.subscriber._controller.add_reference = _mistake  # type: ignore[method-assign, assignment]
    _node(desk, logic, told)._on_idle()
    desk.subscriber.close()
    said = "a request raised ZeroDivisionError: a mistake"
    assert told == [("requests", said)]
    assert (logic.mode is Mode.LATCHED) == (arming is Arming.REQUEST)
    assert said in logic.reason or arming is Arming.AUTOMATIC
    assert [(reply.id, reply.reason) for reply in desk.replies] == [
        ("here", "ZeroDivisionError: a mistake")
    ]

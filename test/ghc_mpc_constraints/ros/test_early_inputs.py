"""Inputs that come before the first tick: as many as fit, and none keeps a tick from its plan."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from ghc_msgs.msg import ContactSchedule

from ghc_controller.ros.wire.cdr import encode_tick
from ghc_mpc_constraints.ros.early_messages import MOST_EARLY, EarlyMessages
from ghc_mpc_constraints.ros.generator_node import GeneratorNode
from ghc_mpc_constraints.ros.take_over import TakeOver
from ghc_mpc_constraints.ros.tick_clock import TickClock

STEP_NS = 10_000_000  # [ns]


def _broken(_: Any) -> bool:
    raise ValueError("a reader of another package")


def test_an_input_that_raises_is_rejected_once_and_the_tick_is_planned() -> None:
    said: list[tuple[str, str]] = []
    planned: list[int] = []
    node: Any = GeneratorNode.__new__(GeneratorNode)
    node._clock = TickClock(STEP_NS)
    node._reject = lambda *words: said.append(words)
    node._input = SimpleNamespace(topic="schedule", newest_only=False, take=_broken)
    node._early = EarlyMessages(node._clock)
    node._try_tick = planned.append
    for _ in range(MOST_EARLY + 5):
        node._on_input(ContactSchedule())
    for tick in range(2):
        node._on_tick(encode_tick(tick * STEP_NS, 0))
    assert planned == [0, STEP_NS]
    assert len(said) == MOST_EARLY
    assert "a reader of another package" in said[0][1]


def test_bytes_that_are_no_state_are_rejected_before_the_first_plan() -> None:
    """That plan of a run under way begins with what the controller's state says is active."""
    said: list[tuple[str, str]] = []
    generator: Any = SimpleNamespace(kind="contact_forces")
    take_over = TakeOver(generator, SimpleNamespace(), 0.0, lambda *words: said.append(words))
    take_over.hear(b"\x00\x01\x00\x00")
    assert not take_over.waits(5 * STEP_NS, 0)
    assert [field for field, _ in said] == ["ghc/controller_state"]

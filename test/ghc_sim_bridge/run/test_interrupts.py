"""Ctrl-C ends a command with exit code 130, whatever the interrupt became on its way."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import pytest

from ghc_controller.ros.stop_signals import STOP_SIGNALS, raise_if_stopped, stop_was_asked
from ghc_sim_bridge.run.interrupts import INTERRUPTED, interruptible


@pytest.fixture(autouse=True)
def _handlers_are_put_back() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in STOP_SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def _ctrl_c(number: int = signal.SIGINT) -> None:
    os.kill(os.getpid(), number)


@pytest.mark.parametrize("number", STOP_SIGNALS)
def test_a_stop_signal_ends_a_command(number: int, capsys: pytest.CaptureFixture[str]) -> None:
    def command() -> int:
        _ctrl_c(number)
        return 0

    assert interruptible("name", command) == INTERRUPTED
    assert capsys.readouterr().err == "name: interrupted; all nodes were ended\n"


def test_an_interrupt_that_became_another_error_still_counts() -> None:
    # pybind11 does this to an interrupt that falls into the conversion of a message.
    def command() -> int:
        try:
            _ctrl_c()
        except KeyboardInterrupt:
            raise RuntimeError("Unable to convert call argument '0'") from None
        return 0

    assert interruptible("name", command) == INTERRUPTED


def test_a_swallowed_interrupt_is_raised_at_the_next_turn() -> None:
    turns = []

    def command() -> int:
        try:
            _ctrl_c()
        except KeyboardInterrupt:
            turns.append("swallowed")
        raise_if_stopped()
        turns.append("went on")
        return 0

    assert interruptible("name", command) == INTERRUPTED
    assert turns == ["swallowed"]


def test_a_failure_after_an_interrupt_is_an_interrupt() -> None:
    def command() -> int:
        try:
            _ctrl_c()
        except KeyboardInterrupt:
            return 1
        return 0

    assert interruptible("name", command) == INTERRUPTED


def test_without_a_signal_codes_and_errors_pass() -> None:
    def broken() -> int:
        raise RuntimeError("the command's own")

    assert interruptible("name", lambda: 3) == 3
    assert not stop_was_asked()
    with pytest.raises(RuntimeError, match="own"):
        interruptible("name", broken)

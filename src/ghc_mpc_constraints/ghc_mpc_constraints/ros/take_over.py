"""Lets a generator that starts during a run continue from the current bounds."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_controller.types import NANOSECONDS
from ghc_mpc_constraints.generator import Generator
from ghc_mpc_constraints.ros.conversions import in_force
from ghc_mpc_constraints.ros.inputs import Input, Reject


class TakeOver:
    """Waits for the current bounds from the controller, and for inputs, up to a timeout."""

    def __init__(
        self,
        generator: Generator,
        given: Input,
        timeout: float,
        reject: Reject,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Wait at most `timeout` [s] of wall time; `clock` returns it [s]."""
        self.done = False  # the first plan was made: no further take-over
        self._generator, self._input = generator, given
        self._timeout, self._reject, self._wall = timeout, reject, clock
        self._states: list[bytes] = []  # the last two controller_states
        self._waiting_since: float | None = None  # [s] wall

    def hear(self, state: bytes) -> None:
        """Keep a serialized ControllerState."""
        if not self.done:
            self._states = [*self._states[-1:], state]

    def waits(self, start_ns: int, run_ns: int) -> bool:
        """Whether the first plan, at `start_ns` [ns] of a run begun at `run_ns`, has to wait."""
        if self.done or start_ns == run_ns:
            return False
        try:
            if self._states and self._take(start_ns):
                return False
        except Exception as error:  # a message may be anything
            self._reject("ghc/controller_state", f"message rejected, {error}")
            self._states.clear()
        if self._waiting_since is None:
            self._waiting_since = self._wall()
        return self._wall() - self._waiting_since < self._timeout

    def end(self) -> None:
        """The first plan was made."""
        self.done = True
        self._states.clear()

    def _take(self, start_ns: int) -> bool:
        """Start from the current bounds; False while inputs for them are missing."""
        found = in_force(self._states, start_ns / NANOSECONDS, self._generator.kind)
        self._generator.take_over(found)
        return self._input.can_take_over(found)

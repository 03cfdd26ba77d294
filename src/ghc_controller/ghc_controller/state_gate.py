"""Which robot states are answered: new ones once, repeated ones alike, old ones not at all."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import Generic, TypeVar

from ghc_controller.types import Array

M = TypeVar("M")


class Verdict(Enum):
    """What a state message is."""

    NEW = "new"  # to be answered
    NEW_EPOCH = "new epoch"  # to be answered after forgetting the past
    REPEATED = "repeated"  # answered before: the same command again
    STALE = "stale"  # older than the last answered one
    WAITING = "waiting"  # wrenches of the same stamp are still to come
    MALFORMED = "malformed"  # the epoch is no number


class StateGate(Generic[M]):
    """Pairs states with the contact wrenches of the same stamp and tells repeats from news.

    The stamp is the sequence number of a state; time runs backwards only with a new epoch.
    """

    def __init__(self, contacts: Sequence[str]) -> None:
        self._contacts = tuple(contacts)
        self._stamps = dict.fromkeys(self._contacts, -1)
        self._values: dict[str, Array] = {}
        self._waiting: tuple[M, int, Verdict] | None = None
        self._answered_ns = -1
        self._repeatable = False
        self.epoch = 0

    @property
    def wrenches(self) -> dict[str, Array]:
        """Wrenches that belong to the state under way; name -> (6,)."""
        return dict(self._values)

    def state(self, message: M, stamp_ns: int, epoch: str) -> Verdict:
        """Judge a state message by its stamp and epoch (`frame_id`; "" is epoch 0)."""
        if epoch and not epoch.isdecimal():
            return Verdict.MALFORMED
        number = int(epoch or 0)
        if number < self.epoch:
            return Verdict.STALE
        if number > self.epoch:
            self.epoch = number
            self._answered_ns = -1
            self._repeatable = False
            return self._complete(message, stamp_ns, Verdict.NEW_EPOCH)
        if stamp_ns < self._answered_ns:
            return Verdict.STALE
        if stamp_ns == self._answered_ns and self._repeatable:
            return Verdict.REPEATED
        return self._complete(message, stamp_ns, Verdict.NEW)

    def wrench(self, name: str, stamp_ns: int, value: Array) -> tuple[M, Verdict] | None:
        """Take a wrench; returns the state message that it completes, if any."""
        self._stamps[name] = stamp_ns
        self._values[name] = value
        if self._waiting is None:
            return None
        message, wanted_ns, verdict = self._waiting
        if any(stamp != wanted_ns for stamp in self._stamps.values()):
            return None
        self._waiting = None
        return message, verdict

    def answered(self, stamp_ns: int) -> None:
        """A command for this state was published."""
        self._answered_ns = stamp_ns
        self._repeatable = True

    def forget(self) -> None:
        """Work a repeat of the last state out again: something new is to be taken into account."""
        self._repeatable = False

    def _complete(self, message: M, stamp_ns: int, verdict: Verdict) -> Verdict:
        if all(stamp == stamp_ns for stamp in self._stamps.values()):
            self._waiting = None
            return verdict
        if self._waiting is not None and self._waiting[2] is Verdict.NEW_EPOCH:
            verdict = Verdict.NEW_EPOCH  # a repeat of the first state must not hide the reset
        self._waiting = (message, stamp_ns, verdict)
        return Verdict.WAITING

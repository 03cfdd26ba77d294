"""Decides which stamps belong to the current run; no single message can block valid ones."""

from __future__ import annotations

import time
from collections.abc import Callable
from enum import Enum

from ghc_controller.types import NANOSECONDS

MOST_AHEAD_NS = 100_000_000  # [ns] a stamp may be ahead of the one before; see `Timeline`
CONFIRMATIONS = 3  # [-] consecutive messages that confirm another run
SILENCE = 0.05  # [s] wall; required silence of the current run before that


class Place(Enum):
    """Relation of a stamp to the current run."""

    NEXT = "next"  # at or behind the last one, near it
    OLDER = "older"  # before the last one
    ELSEWHERE = "elsewhere"  # far ahead, or of another epoch: not accepted yet
    RESUMED = "resumed"  # as ELSEWHERE or OLDER in the same epoch, and confirmed: continue there
    RESTARTED = "restarted"  # a run begins that was announced or confirmed: reset the history


class Timeline:
    """Follows the stamps of a stream with possibly invalid messages.

    A stamp shortly after the last one continues the run. Any other one is followed at once where
    it is near the start of an announced run (`sim_bridge/epoch`): two topics agree. Otherwise it
    is followed only after CONFIRMATIONS consecutive stamps, each continuing the one before, and
    only if the current run has sent nothing for SILENCE. So a reset is followed at once, a
    restarted bridge or driver and an interrupted link after that time, and neither a forged stamp
    nor a forged announcement is followed while valid stamps keep arriving. The very first stamp is
    accepted.
    """

    def __init__(
        self, most_ahead_ns: int = MOST_AHEAD_NS, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Start without a run.

        Args:
            most_ahead_ns: [ns] largest difference of consecutive stamps of a run.
            clock: returns wall time [s].
        """
        self.most_ahead_ns = most_ahead_ns
        self._clock = clock
        self._heard_at = 0.0  # [s] wall, last message of the run
        self._other: tuple[int | None, int] | None = None
        self._in_a_row = 0
        self._begun = False
        self._first_ns = 0  # [ns] first stamp of the run
        self._announced: tuple[int, int] | None = None  # epoch and start [ns], not begun yet
        self.resumed = False  # whether the last message is RESUMED
        self.epoch = 0  # number of the current run; 0 if none was announced
        self.start_ns: int | None = None  # [ns] of the current run, if it was announced
        self.last_ns = -1  # [ns] stamp followed last; -1 before the first

    def announce(self, epoch: int, start_ns: int) -> None:
        """A run begins at `start_ns` [ns], or has begun there and is the current one."""
        if self._begun and self.start_ns is None and start_ns <= self._first_ns:
            self.epoch, self.start_ns = epoch, start_ns
        elif (epoch, start_ns) != (self.epoch, self.start_ns) or self.last_ns > start_ns:
            self._announced = (epoch, start_ns)

    def judge(self, stamp_ns: int, epoch: int | None = None) -> Place:
        """Classify a message; NEXT, RESUMED and RESTARTED advance to it.

        Args:
            stamp_ns: [ns] of the message.
            epoch: its run, if the message contains it.
        """
        now = self._clock()
        self.resumed = False
        if not self._begun:
            return self._begin(stamp_ns, epoch, now)
        ahead = stamp_ns - self.last_ns
        if self._is_own(epoch) and 0 <= ahead <= self.most_ahead_ns:
            self._follow(stamp_ns, now)
            return Place.NEXT
        if self._is_announced(stamp_ns, epoch):
            self._restart(stamp_ns, epoch, now)
            return Place.RESTARTED
        older = ahead < 0 if self._is_own(epoch) else (epoch or 0) < self.epoch
        if not self._confirmed(stamp_ns, epoch, now):
            return Place.OLDER if older else Place.ELSEWHERE
        if (
            self._is_own(epoch)
            and ahead > -self.most_ahead_ns
            and not self._passes_start(stamp_ns)
        ):
            self.resumed = True
            self._follow(stamp_ns, now)
            return Place.RESUMED
        self._restart(stamp_ns, epoch, now)
        return Place.RESTARTED

    def is_stale(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that has ended."""
        return self.start_ns is not None and stamp_ns < self.start_ns

    def expected(self) -> str:
        """Which stamps are expected, for the reason of a rejection."""
        ahead, last = self.most_ahead_ns / NANOSECONDS, self.last_ns / NANOSECONDS
        return (
            f"at most {ahead:g} s after {last:.6f} s in epoch {self.epoch} expected; another time "
            f"is followed at the start of an announced run, or once {CONFIRMATIONS} messages in a "
            f"row confirm it and this one was silent for {SILENCE:g} s"
        )

    def is_of_next_run(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] belongs to an announced run that has not begun."""
        return self._begun and self._passes_start(stamp_ns)

    def _begin(self, stamp_ns: int, epoch: int | None, now: float) -> Place:
        self._begun = True
        self._restart(stamp_ns, epoch, now)
        return Place.NEXT if self.epoch == 0 else Place.RESTARTED

    def _is_own(self, epoch: int | None) -> bool:
        return epoch is None or epoch == self.epoch

    def _is_announced(self, stamp_ns: int, epoch: int | None) -> bool:
        """Whether an announced run that has not begun starts with a stamp."""
        announced = self._announced
        return (
            announced is not None
            and self._is_behind(announced, stamp_ns, epoch)
            and stamp_ns - announced[1] <= self.most_ahead_ns
        )

    def _is_behind(self, announced: tuple[int, int], stamp_ns: int, epoch: int | None) -> bool:
        """Whether a stamp can belong to an announced run; a tick may precede its first state."""
        number, start_ns = announced
        return epoch in (None, number) and stamp_ns >= start_ns - self.most_ahead_ns

    def _passes_start(self, stamp_ns: int) -> bool:
        """Whether the start of an announced run lies between the last stamp and this one."""
        return self._announced is not None and self.last_ns < self._announced[1] <= stamp_ns

    def _restart(self, stamp_ns: int, epoch: int | None, now: float) -> None:
        """Begin a run at this stamp: the announced one if the stamp can belong to it."""
        announced, self.start_ns = self._announced, None
        if announced is not None and self._is_behind(announced, stamp_ns, epoch):
            self.epoch, self.start_ns = announced
            self._announced = None
        elif epoch is not None:
            self.epoch = epoch
        self._first_ns = stamp_ns
        self._follow(stamp_ns, now)

    def _follow(self, stamp_ns: int, now: float) -> None:
        self.last_ns, self._heard_at = stamp_ns, now
        self._other, self._in_a_row = None, 0

    def _confirmed(self, stamp_ns: int, epoch: int | None, now: float) -> bool:
        other = self._other
        continues = (
            other is not None
            and epoch == other[0]
            and 0 <= stamp_ns - other[1] <= self.most_ahead_ns
        )
        self._in_a_row = self._in_a_row + 1 if continues else 1
        self._other = (epoch, stamp_ns)
        return self._in_a_row >= CONFIRMATIONS and now - self._heard_at >= SILENCE

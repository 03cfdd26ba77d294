"""Which stamps belong to the run under way, so that no single message can hide those that do."""

from __future__ import annotations

import time
from collections.abc import Callable
from enum import Enum

from ghc_controller.types import NANOSECONDS

MOST_AHEAD_NS = 100_000_000  # [ns] a stamp may be ahead of the one before; see `Timeline`
CONFIRMATIONS = 3  # [-] messages in a row that make another run believable
SILENCE = 0.05  # [s] wall; so long the run under way has to be silent before


class Place(Enum):
    """What a stamp is to the run under way."""

    NEXT = "next"  # at or behind the last one, near it
    OLDER = "older"  # before the last one
    ELSEWHERE = "elsewhere"  # far ahead, or of another epoch: not believed yet
    RESUMED = "resumed"  # as ELSEWHERE or OLDER in the same epoch, and confirmed: go on there
    RESTARTED = "restarted"  # a run begins that was announced or confirmed: forget the past


class Timeline:
    """Follows the stamps of a stream that may contain anything.

    A stamp shortly after the last one continues the run. Any other one is followed at once where
    it is near the start of a run that was announced (`sim_bridge/epoch`): two topics agree.
    Otherwise it is followed only when CONFIRMATIONS of them came in a row, each continuing the
    one before, after the run under way has been silent for SILENCE. So a reset is followed at
    once, a restarted bridge or driver and a cut link after that time, and neither a forged stamp
    nor a forged announcement ever is, as long as the true stamps keep coming. The first stamp of
    all is believed.
    """

    def __init__(
        self, most_ahead_ns: int = MOST_AHEAD_NS, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Nothing seen yet.

        Args:
            most_ahead_ns: [ns] from one stamp to the next one of a run, at most.
            clock: gives wall time [s].
        """
        self.most_ahead_ns = most_ahead_ns
        self._clock = clock
        self._heard_at = 0.0  # [s] wall, of the last message of the run
        self._other: tuple[int | None, int] | None = None
        self._in_a_row = 0
        self._begun = False
        self._first_ns = 0  # [ns] stamp of the run with which it was begun here
        self._announced: tuple[int, int] | None = None  # epoch and start [ns], not begun yet
        self.resumed = False  # whether the message judged last is RESUMED
        self.epoch = 0  # number of the run under way; 0 where none was announced
        self.start_ns: int | None = None  # [ns] of the run under way, where it was announced
        self.last_ns = -1  # [ns] stamp followed last; -1 before the first

    def announce(self, epoch: int, start_ns: int) -> None:
        """A run begins at `start_ns` [ns], or has begun there and is the one under way."""
        if self._begun and self.start_ns is None and start_ns <= self._first_ns:
            self.epoch, self.start_ns = epoch, start_ns
        elif (epoch, start_ns) != (self.epoch, self.start_ns) or self.last_ns > start_ns:
            self._announced = (epoch, start_ns)

    def judge(self, stamp_ns: int, epoch: int | None = None) -> Place:
        """Where a message belongs; NEXT, RESUMED and RESTARTED move on to it.

        Args:
            stamp_ns: [ns] of the message.
            epoch: its run, where the message says so.
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
        """What is expected of a stamp, for the reason of a refusal."""
        ahead, last = self.most_ahead_ns / NANOSECONDS, self.last_ns / NANOSECONDS
        return (
            f"at most {ahead:g} s after {last:.6f} s in epoch {self.epoch} expected; another time "
            f"is followed at the start of an announced run, or once {CONFIRMATIONS} messages in a "
            f"row confirm it and this one was silent for {SILENCE:g} s"
        )

    def is_of_next_run(self, stamp_ns: int) -> bool:
        """Whether a stamp [ns] is of a run that was announced and has not begun."""
        return self._begun and self._passes_start(stamp_ns)

    def _begin(self, stamp_ns: int, epoch: int | None, now: float) -> Place:
        self._begun = True
        self._restart(stamp_ns, epoch, now)
        return Place.NEXT if self.epoch == 0 else Place.RESTARTED

    def _is_own(self, epoch: int | None) -> bool:
        return epoch is None or epoch == self.epoch

    def _is_announced(self, stamp_ns: int, epoch: int | None) -> bool:
        """Whether a run that was announced and has not begun begins with a stamp."""
        announced = self._announced
        return (
            announced is not None
            and self._is_behind(announced, stamp_ns, epoch)
            and stamp_ns - announced[1] <= self.most_ahead_ns
        )

    def _is_behind(self, announced: tuple[int, int], stamp_ns: int, epoch: int | None) -> bool:
        """Whether a stamp can be of an announced run; a tick may begin before its first state."""
        number, start_ns = announced
        return epoch in (None, number) and stamp_ns >= start_ns - self.most_ahead_ns

    def _passes_start(self, stamp_ns: int) -> bool:
        """Whether the start of an announced run lies between the last stamp and this one."""
        return self._announced is not None and self.last_ns < self._announced[1] <= stamp_ns

    def _restart(self, stamp_ns: int, epoch: int | None, now: float) -> None:
        """Begin a run here, the announced one if the stamp can be of it."""
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

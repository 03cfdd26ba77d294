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
    RESTARTED = "restarted"  # of another epoch, or long before, and confirmed: forget the past


class Timeline:
    """Follows (epoch, stamp) of a stream that may contain anything.

    A stamp shortly after the last one continues the run. Any other one, of an epoch however
    high or low, is followed only when CONFIRMATIONS of them came in a row, each continuing the
    one before, after the run under way has been silent for SILENCE. So a reset, a restarted
    bridge and a cut link are followed after that time, and a forged stamp never is, as long as
    the true ones keep coming. The first stamp of all is believed.
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
        self._other: tuple[int, int] | None = None
        self._in_a_row = 0
        self._begun = False
        self.resumed = False  # whether the message judged last is RESUMED
        self.epoch = 0
        self.last_ns = -1  # [ns] stamp followed last; -1 before the first

    def judge(self, stamp_ns: int, epoch: int) -> Place:
        """Where a message belongs; NEXT, RESUMED and RESTARTED move on to it."""
        now = self._clock()
        self.resumed = False
        if not self._begun:
            new, self._begun = epoch != self.epoch, True
            self._follow(stamp_ns, epoch, now)
            return Place.RESTARTED if new else Place.NEXT
        ahead = stamp_ns - self.last_ns
        if epoch == self.epoch and 0 <= ahead <= self.most_ahead_ns:
            self._follow(stamp_ns, epoch, now)
            return Place.NEXT
        older = epoch < self.epoch or (epoch == self.epoch and ahead < 0)
        if not self._confirmed(stamp_ns, epoch, now):
            return Place.OLDER if older else Place.ELSEWHERE
        self.resumed = same = epoch == self.epoch and ahead > -self.most_ahead_ns
        self._follow(stamp_ns, epoch, now)
        return Place.RESUMED if same else Place.RESTARTED

    def expected(self) -> str:
        """What is expected of a stamp, for the reason of a refusal."""
        ahead, last = self.most_ahead_ns / NANOSECONDS, self.last_ns / NANOSECONDS
        return (
            f"at most {ahead:g} s after {last:.6f} s in epoch {self.epoch} expected; another time "
            f"is followed once {CONFIRMATIONS} messages in a row confirm it and this one was "
            f"silent for {SILENCE:g} s"
        )

    def _follow(self, stamp_ns: int, epoch: int, now: float) -> None:
        self.epoch, self.last_ns, self._heard_at = epoch, stamp_ns, now
        self._other, self._in_a_row = None, 0

    def _confirmed(self, stamp_ns: int, epoch: int, now: float) -> bool:
        other = self._other
        continues = (
            other is not None
            and epoch == other[0]
            and 0 <= stamp_ns - other[1] <= self.most_ahead_ns
        )
        self._in_a_row = self._in_a_row + 1 if continues else 1
        self._other = (epoch, stamp_ns)
        return self._in_a_row >= CONFIRMATIONS and now - self._heard_at >= SILENCE

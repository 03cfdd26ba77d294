"""The /clock of another host, as far as it can be believed."""

from __future__ import annotations

import time
from collections.abc import Callable

from ghc_controller.ros.wire.in_a_row import InARow
from ghc_controller.types import NANOSECONDS

IN_A_ROW = 5  # [-] messages that go on from one another, before they are believed
MOST_STEP_NS = NANOSECONDS  # [ns] from one of them to the next
SILENCE = 5.0  # [s] wall without it: it has ended
PATIENCE = 30.0  # [s] wall, after which an own time that is behind it is published all the same


class HeardClock:
    """Follows the times that are ahead of one's own; a forged one, however far, changes nothing.

    Attributes:
        time_ns: the newest time that is believed [ns]; -1 = there is no such clock.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` gives wall time [s]."""
        self._clock = clock
        self.forget()

    def forget(self) -> None:
        """Nothing was heard yet."""
        self.time_ns = -1
        self._heard_at = float("-inf")  # [s] wall, of what is believed
        self._candidate = InARow(IN_A_ROW, MOST_STEP_NS)  # what may be believed

    def hear(self, stamp_ns: int, own_ns: int) -> bool:
        """Take a message at one's own time; True when a clock ahead of it is believed from now on.

        Without a believed one, times that are not ahead are one's own, or of one that is behind.
        """
        if self.time_ns >= 0 and 0 <= stamp_ns - self.time_ns <= MOST_STEP_NS:
            self.time_ns, self._heard_at = stamp_ns, self._clock()
            return False
        if self.time_ns < 0 and stamp_ns <= own_ns:
            return False
        if not self._candidate.hear(stamp_ns):
            return False
        begins = self.time_ns < 0
        self.time_ns, self._heard_at = stamp_ns, self._clock()
        return begins

    def leaves_to(self, own_ns: int) -> bool:
        """Whether a bridge whose time is `own_ns` may publish: the clock ended, or never was.

        Where its time is behind, so that the clock goes back, it waits longer.
        """
        if self.time_ns < 0:
            return True
        silent = self._clock() - self._heard_at
        return silent > (SILENCE if own_ns > self.time_ns else PATIENCE)

"""Priorities that follow a distance: the share of an order in a mixture of two."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.transition import Profile

_STANDS = 1e-3  # [-] a share that near to the wanted one stays where it is
HELD = 1e6  # [s] duration of a ramp that does not move


class Move(NamedTuple):
    """A linear ramp towards one of the two orders: what a transition can express."""

    to_second: bool
    duration: float  # [s] of the whole way that is left


@dataclass(frozen=True, slots=True)
class DistanceShare:
    """Share s of the second of two orders, from a value that grows or falls with a distance.

    s goes from 0 at `begins` to 1 at `ends` along a minimum-jerk profile (Han et al., 2021,
    eq. 11, whose profile is lost in print). It is a target that changes all the time. It is
    reached by ramps, each of which takes the place of the one before: a linear ramp from the
    mixture (1 - s, s) with the duration D moves the share by (1 - s) / D towards the second
    order, or by s / D towards the first.

    Raises:
        InvalidValue: `begins` equals `ends`, a value is not finite, or a time is not positive.
    """

    begins: float  # value at which the share is 0
    ends: float  # value at which it is 1
    lag: float = 0.03  # [s] time constant with which the share follows
    full_way: float = 0.2  # [s] from 0 to 1 at least: limits the speed of the share

    def __post_init__(self) -> None:
        if not (math.isfinite(self.begins) and math.isfinite(self.ends)):
            raise InvalidValue(
                f"begins = {self.begins:g}, ends = {self.ends:g} given, finite values expected"
            )
        if self.begins == self.ends:
            raise InvalidValue(f"begins = ends = {self.begins:g} given, two values expected")
        if not (self.lag > 0.0 and self.full_way > 0.0):
            raise InvalidValue(
                f"lag = {self.lag:g} s, full_way = {self.full_way:g} s given, positive ones "
                "expected"
            )

    def wanted(self, value: float) -> float:
        """Share in [0, 1] that belongs to a value."""
        return Profile.MINIMUM_JERK.progress((value - self.begins) / (self.ends - self.begins))

    def move(self, share: float, value: float) -> Move | None:
        """Ramp from a mixture with `share` of the second order, to be replaced by the next one.

        None where the share is 0 or 1 and stays so.
        """
        wanted = self.wanted(value)
        missing = wanted - share
        if missing == 0.0 and share in (0.0, 1.0):
            return None
        to_second = missing > 0.0
        left = 1.0 - share if to_second else share
        if abs(missing) < _STANDS and 0.0 < wanted < 1.0:
            return Move(to_second, HELD)
        return Move(to_second, left / min(abs(missing) / self.lag, 1.0 / self.full_way))


class ShareFollower:
    """Leaves out moves that change nothing: a ramp to an end, or a held one, is not renewed."""

    def __init__(self, share: DistanceShare) -> None:
        """Nothing under way."""
        self.share = share
        self._under_way: tuple[bool, float] | None = None
        self._before = math.nan

    def next(self, share: float, value: float) -> Move | None:
        """The ramp to ask for now, None where what is under way will do.

        Args:
            share: of the second order, as the controller reports it.
            value: that the share follows.
        """
        move = self.share.move(share, value)
        if move is None:
            self._under_way = None
            return None
        wanted = self.share.wanted(value)
        key = None
        if move.duration == HELD:
            key = (move.to_second, HELD)
        elif wanted in (0.0, 1.0):
            key = (move.to_second, wanted)
        moves = share != self._before
        self._before = share
        if key is not None and key == self._under_way and (moves or move.duration == HELD):
            return None
        self._under_way = key
        return move

"""When a measured position of an obstacle counts: approaching ones late, leaving ones at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array

SAME_PLACE = 1e-9  # [m] closer or farther than this is neither


@dataclass(frozen=True, slots=True)
class ReactionTime:
    """Time that the robot is given to make room, t_r >= d_v / v_max (eq. 4.4)."""

    max_velocity: float = declared(
        "v_max of eq. 4.4: how fast the robot can make room", 0.1, unit="m/s", domain=POSITIVE
    )
    shortest: float = declared(
        "at least, for however small an approach; eq. 4.4 is for larger ones",
        0.3,
        unit="s",
        domain=POSITIVE,
        name="reaction_time",
    )

    def __post_init__(self) -> None:
        """Raise InvalidValue for values that are not finite and positive."""
        check(self)

    def of(self, violation: float) -> float:
        """Reaction time [s] to an approach by `violation` [m]."""
        return max(violation / self.max_velocity, self.shortest)


class ApproachQueue:
    """Reference positions with the times from which each is in force, closer and closer.

    A position that is closer than the ones before is in force a reaction time later: the
    obstacle is taken to stand still meanwhile (assumption 2 of section 4.4.1). One that is
    farther is in force at once, but takes no deadline away from what is closer than it: it is
    due when the first position closer than itself would have been.
    """

    def __init__(self, point: Array, now: float) -> None:
        """Begin with a position (3,) in force."""
        self._times = [now]
        self._points = [point]

    @property
    def newest(self) -> Array:
        """The position (3,) that is in force last."""
        return self._points[-1]

    def move(self, point: Array, normal: Array, now: float, reaction: ReactionTime) -> None:
        """Take a new position; `normal` (3,) points from the obstacle to what it threatens."""
        self._forget_past(now)
        distance = -np.array(self._points) @ normal
        given = -float(point @ normal)
        if distance[0] <= given + SAME_PLACE:
            self._times, self._points = [now], [point]
            return
        kept = int(np.count_nonzero(distance > given + SAME_PLACE))  # they come first
        if kept < len(self._times):
            due = self._times[kept]
        elif kept == 1:
            due = now + reaction.of(distance[0] - given)
        else:  # the time after the deadline before is for the rest of the way
            due = self._times[-1] + (distance[-1] - given) / reaction.max_velocity
            due = max(due, now + reaction.shortest)
        self._times = [*self._times[:kept], due]
        self._points = [*self._points[:kept], point]

    def preview(self, times: Array) -> Array:
        """Reference positions (len(times), 3) at increasing times [s]."""
        index = np.searchsorted(np.array(self._times), times + 1e-9, side="right") - 1
        return np.array(self._points)[np.maximum(index, 0)]

    def _forget_past(self, now: float) -> None:
        current = int(np.searchsorted(np.array(self._times), now + 1e-9, side="right")) - 1
        self._times = self._times[max(current, 0) :]
        self._points = self._points[max(current, 0) :]

"""When a measured obstacle position takes effect: approaching ones after a reaction time, receding
ones at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array

SAME_PLACE = 1e-9  # [m] smaller changes of the distance are ignored


@dataclass(frozen=True, slots=True)
class ReactionTime:
    """Time for the robot to move away, t_r >= d_v / v_max (eq. 4.4)."""

    max_velocity: float = declared(
        "v_max of eq. 4.4: how fast the robot can move away", 0.1, unit="m/s", domain=POSITIVE
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
    """Queue of reference positions with their activation times, in order of approach.

    A position closer than the previous ones becomes active after the reaction time, during which
    the obstacle is assumed to be at rest (assumption 2 of section 4.4.1). A farther one is active
    at once, but keeps the deadlines of closer positions: its deadline is that of the first
    position closer than itself.
    """

    def __init__(self, point: Array, now: float) -> None:
        """Start with an active position (3,)."""
        self._times = [now]
        self._points = [point]

    @property
    def newest(self) -> Array:
        """The last position (3,) of the queue."""
        return self._points[-1]

    def move(self, point: Array, normal: Array, now: float, reaction: ReactionTime) -> None:
        """Add a new position; `normal` (3,) points from the obstacle to the protected frame."""
        self._forget_past(now)
        distance = -np.array(self._points) @ normal
        given = -float(point @ normal)
        if distance[0] <= given + SAME_PLACE:
            self._times, self._points = [now], [point]
            return
        kept = int(np.count_nonzero(distance > given + SAME_PLACE))  # these come first
        if kept < len(self._times):
            due = self._times[kept]
        elif kept == 1:
            due = now + reaction.of(distance[0] - given)
        else:  # the time after the previous deadline is for the remaining distance
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

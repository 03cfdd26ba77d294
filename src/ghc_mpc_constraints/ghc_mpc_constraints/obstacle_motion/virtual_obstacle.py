"""Virtual obstacle for the controller: enters at the edge, moves, leaves over the edge."""

from __future__ import annotations

import numpy as np

from ghc_controller.types import Array
from ghc_mpc_constraints.obstacle_motion.approach import ApproachQueue, ReactionTime
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement

REACHED = 0.1  # [-] tolerance, as a fraction of the margin, for an obstacle to be outside again


class VirtualObstacle:
    """Follows the measurements of one obstacle.

    Outside (farther than safe distance + margin) it equals the measured obstacle, and its
    constraint is inactive. When the obstacle enters, it starts at the edge (assumption 1 of
    section 4.4.1), where the margin keeps its constraint inactive. When the obstacle leaves or is
    no longer measured, it first moves to the edge.
    """

    def __init__(self, margin: float, reaction: ReactionTime) -> None:
        """Start without a measurement; `margin` [m]."""
        self._margin = margin
        self._reaction = reaction
        self._edge = np.zeros(3)
        self._leaving = False
        self.measurement: Measurement | None = None
        self.outside = True
        self.seen = False
        self.state = np.zeros((3, 3))  # position, velocity, acceleration by row; world axes
        self.reference = ApproachQueue(np.zeros(3), 0.0)

    def observe(self, measurement: Measurement, now: float) -> None:
        """Update with a measurement."""
        self.measurement = measurement
        self.seen = True
        self._edge = measurement.away(self._margin)
        self._leaving = measurement.distance >= measurement.safe_distance + self._margin
        target = self._edge if self._leaving else measurement.position
        if self.outside and self._leaving:
            self._rest_at(measurement.position)
            return
        if self.outside:
            self.enter(at_rest(self._edge), now)
        self.reference.move(target, measurement.normal, now, self._reaction)

    def enter(self, state: Array, now: float) -> None:
        """Start it inside at a state (3, 3), from which it moves smoothly."""
        self.outside = False
        self.state = state
        self.reference = ApproachQueue(state[0], now)

    def vanish(self, now: float) -> None:
        """The sensor no longer reports it."""
        if self.measurement is None or not self.seen:
            return
        self.seen = False
        self._leaving = True
        if not self.outside:
            self.reference.move(self._edge, self.measurement.normal, now, self._reaction)

    def advance(self, state: Array) -> None:
        """Update to the state of the previous plan, and detect when the edge is reached."""
        if self.outside or self.measurement is None:
            return
        self.state = state
        way = float((state[0] - self._edge) @ self.measurement.normal)  # remaining distance [m]
        if self._leaving and way <= REACHED * self._margin:
            self._rest_at(self.measurement.position)

    @property
    def gone(self) -> bool:
        """True if it is neither measured nor published."""
        return self.outside and not self.seen

    def _rest_at(self, point: Array) -> None:
        self.outside = True
        self.state = at_rest(point)


def at_rest(point: Array) -> Array:
    """State (3, 3) at a position (3,), without velocity and acceleration."""
    state = np.zeros((3, 3))
    state[0] = point
    return state

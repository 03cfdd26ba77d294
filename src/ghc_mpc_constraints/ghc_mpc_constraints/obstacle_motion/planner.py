"""Plans the virtual motion of one obstacle over a receding horizon (eq. 4.11 to 4.16)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ghc_controller.previews.motion import PlannedMotion
from ghc_controller.previews.status import PreviewStatus
from ghc_controller.types import Array
from ghc_mpc_constraints.obstacle_motion.measurement import Measurement, frame_of
from ghc_mpc_constraints.obstacle_motion.settings import ObstacleSettings
from ghc_mpc_constraints.obstacle_motion.virtual_obstacle import VirtualObstacle, at_rest
from ghc_mpc_constraints.previews.horizon import Horizon
from ghc_mpc_constraints.previews.motion_qp import MotionQp
from ghc_mpc_constraints.previews.motion_weights import (
    dynamic_weights,
    dynamic_weights_two_sided,
)

_STILL = np.zeros((0, 3))


class Before(NamedTuple):
    """The previous plan of an obstacle."""

    jerk: Array  # (N, 3)
    done: int  # steps of it that have passed


class MotionPlanner:
    """Plans obstacles one at a time; nothing is remembered from one plan to the next.

    Along the normal, the virtual obstacle is at most as far from the robot as the measured one
    after the reaction time (eq. 4.14c). The two tangents are smoothed in the same way, without a
    bound.

    Attributes:
        qp: solver of one axis.
    """

    def __init__(self, settings: ObstacleSettings, horizon: Horizon) -> None:
        """Compute the constant matrices."""
        self._settings = settings
        self._horizon = horizon
        self.qp = MotionQp(horizon, settings.jerk_weight)
        self._no_limit = np.full(horizon.steps, np.inf)

    def plan(self, obstacle: VirtualObstacle, time: float, before: Before | None) -> PlannedMotion:
        """Motion of an obstacle that was measured, from `time` [s] on."""
        measurement = obstacle.measurement
        assert measurement is not None
        if not self._settings.smoothing:
            state, jerk = at_rest(measurement.position), _STILL
            status = PreviewStatus.RAW
        elif obstacle.outside:
            state, jerk, status = obstacle.state, _STILL, PreviewStatus.RAW
        else:
            state, jerk, status = self._smooth(obstacle, measurement, time, before)
        return PlannedMotion(
            measurement.id,
            measurement.frame,
            measurement.safe_distance,
            measurement.normal,
            state,
            jerk,
            status,
        )

    def _smooth(
        self,
        obstacle: VirtualObstacle,
        measurement: Measurement,
        time: float,
        before: Before | None,
    ) -> tuple[Array, Array, PreviewStatus]:
        """State (3, 3), jerks (N, 3) and their status."""
        axes = frame_of(measurement.normal)
        raw = axes @ obstacle.reference.preview(self._horizon.times(time)[1:]).T  # (3, N)
        state = axes @ obstacle.state.T  # row = position, velocity, acceleration of an axis
        jerk = np.empty_like(raw)
        for axis in range(3):
            limit = raw[0] if axis == 0 else self._no_limit
            answer = self.qp.solve(state[axis], raw[axis], self._weights(raw[axis], axis), limit)
            if answer is None:
                return _without_solution(obstacle.state, axes, raw, before)
            jerk[axis] = answer
        return obstacle.state, np.ascontiguousarray(jerk.T @ axes), PreviewStatus.SMOOTHED

    def _weights(self, raw: Array, axis: int) -> Array:
        if not self._settings.dynamic_weighting:
            return np.ones_like(raw)
        rule = dynamic_weights if axis == 0 else dynamic_weights_two_sided
        return rule(raw, self._settings.power)


def _without_solution(
    state: Array, axes: Array, raw: Array, before: Before | None
) -> tuple[Array, Array, PreviewStatus]:
    """The remaining previous plan; without one, at rest at the closest upcoming position."""
    if before is not None and 0 <= before.done < len(before.jerk):
        return state, before.jerk[before.done :], PreviewStatus.HELD
    place = axes @ state[0]
    place[0] = min(place[0], raw[0].min())
    return at_rest(place @ axes), _STILL, PreviewStatus.TIGHTENED

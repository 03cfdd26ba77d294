"""How far the robot was from an obstacle: the one of the controller, and the thing itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.model.robot_model import RobotModel
from ghc_controller.types import NANOSECONDS, Array
from ghc_sim_bridge.analysis.generator_metrics import largest
from ghc_sim_bridge.logs.constraint_series import (
    ACCELERATION,
    NORMAL,
    POSITION,
    SAFE_DISTANCE,
    VELOCITY,
    ConstraintSeries,
)
from ghc_sim_bridge.logs.full_rate_log import FullRateLog
from ghc_sim_bridge.scene.values import Obstacle
from ghc_sim_bridge.simulation.obstacle_sensor import position_at

INSIDE = 1e-3  # [m] closer than the safe distance by more than this counts
_SAME_TIME = 1e-6  # [s]


@dataclass(frozen=True, slots=True)
class DistanceHistory:
    """One obstacle and the frame that it threatens, at S times."""

    time: Array  # (S,) [s]
    virtual: Array  # (S,) [m] distance to the obstacle as the controller had it, along the normal
    predicted: Array  # (S,) [m] the same after the horizon of eq. 4.2
    actual: Array  # (S,) [m] distance to the obstacle itself; NaN while it is not seen
    safe_distance: Array  # (S,) [m]

    @property
    def violation(self) -> float:
        """Largest lack of the predicted distance [m]: of eq. 4.2, with what was simulated."""
        return largest(self.safe_distance - self.predicted)

    @property
    def closest(self) -> float:
        """Largest lack of the distance to the obstacle as the controller had it [m]."""
        return largest(self.safe_distance - self.virtual)

    @property
    def time_inside(self) -> float:
        """Time that the frame was inside the safe distance of the obstacle itself [s]."""
        inside = self.safe_distance - self.actual > INSIDE
        return float(np.sum(np.diff(self.time, append=self.time[-1:])[inside]))


def obstacle_distance(
    series: ConstraintSeries,
    obstacle: Obstacle,
    log: FullRateLog,
    model: RobotModel,
    horizon: float,
) -> DistanceHistory:
    """Distance to an obstacle as the controller had it, and that of eq. 4.2 after `horizon` [s].

    `obstacle` is the scene's. Velocity and acceleration of the frame are those of the simulation.
    """
    values = series.obstacles[obstacle.id]
    present = np.isfinite(values).all(axis=1)
    times, values = series.time[present], values[present]
    rows = np.minimum(np.searchsorted(log.time, times - _SAME_TIME), len(log.time) - 1)
    frame = model.frame_id(series.frames[obstacle.id])
    virtual, predicted, actual = (np.full(len(rows), np.nan) for _ in range(3))
    for k, row in enumerate(rows):
        acceleration = _frame_acceleration(log, model, frame, row)
        normal = values[k, NORMAL]
        place = model.frame_position(frame)
        distance = normal @ (place - values[k, POSITION])
        speed = normal @ (model.frame_velocity(frame)[:3] - values[k, VELOCITY])
        growth = normal @ (acceleration - values[k, ACCELERATION])
        virtual[k] = distance
        seen = position_at(obstacle, round(times[k] * NANOSECONDS))
        if seen is not None:
            actual[k] = normal @ (place - np.array(seen))
        predicted[k] = distance + horizon * (speed + 0.5 * horizon * growth)
    return DistanceHistory(times, virtual, predicted, actual, values[:, SAFE_DISTANCE])


def _frame_acceleration(log: FullRateLog, model: RobotModel, frame: int, row: int) -> Array:
    """Acceleration (3,) of a frame at a row [m/s^2], world axes; leaves the model at that row.

    The log has none of a base that floats: there it is the mean over the period that follows.
    """
    joints = model.joint_names
    if log.base_pose is None:
        model.update(log.configuration(row, joints), log.velocity(row, joints))
        order = [log.joint_names.index(joint) for joint in joints]
        acceleration = model.frame_jacobian(frame)[:3] @ log.acceleration[row, order]
        return np.asarray(acceleration + model.frame_drift(frame)[:3])
    last = min(row + 1, len(log.time) - 1)
    model.update(log.configuration(last, joints), log.velocity(last, joints))
    after = model.frame_velocity(frame)[:3].copy()
    model.update(log.configuration(row, joints), log.velocity(row, joints))
    return np.asarray((after - model.frame_velocity(frame)[:3]) / log.control_dt)

"""Settings of a controller beside the robot itself."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ghc_controller.constraints import (
    Constraint,
    ConstraintSet,
    JointPositionLimit,
    JointVelocityLimit,
    TorqueCenter,
    TorqueLimit,
    TorqueRateLimit,
)
from ghc_controller.constraints.planned_jerk import PlannedJerk
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import DEFAULT_FORMULATION, FormulationSettings
from ghc_controller.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Settings:
    """Numbers that a user may change without touching the robot's file.

    Raises:
        InvalidValue: a number outside its range.
    """

    formulation: str = DEFAULT_FORMULATION
    solver: str = "daqp"
    control_dt: float = 1e-3  # [s]
    hierarchy: str = ""  # at the start; "" = of the robot's file
    velocity_limit: float = 0.0  # [rad/s] for every joint; 0 = of the robot
    velocity_horizon: float = 0.05  # [s] over which a velocity limit acts, 10 to 50 ms
    torque_bound: float = 0.0  # [Nm] for every joint; 0 = of the robot
    torque_bound_around: TorqueCenter = TorqueCenter.ZERO
    torque_rate_limit: float = -1.0  # [Nm/s]; 0 = off, negative = of the robot
    obstacle_horizon: float = 0.1  # [s] delta t of eq. 4.2 of the thesis
    position_limits: bool = True
    velocity_limits: bool = True
    optimization: FormulationSettings = field(default_factory=FormulationSettings)

    def __post_init__(self) -> None:
        for name in ("control_dt", "velocity_horizon", "obstacle_horizon"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise InvalidValue(f"{name} = {getattr(self, name)} s given, more than 0 expected")
        for name in ("velocity_limit", "torque_bound"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) >= 0.0):
                raise InvalidValue(f"{name} = {getattr(self, name)} given, at least 0 expected")

    def rate_limit(self, robot: Robot) -> float:
        """Torque rate limit in force [Nm/s]; 0 = off."""
        return robot.torque_rate if self.torque_rate_limit < 0.0 else self.torque_rate_limit


def make_constraints(robot: Robot, settings: Settings) -> ConstraintSet:
    """Constraints of the robot under these settings (design, section 5)."""
    model, limits = robot.model, robot.model.limits
    constraints: list[Constraint] = [TorqueLimit(limits.torque, model.na)]
    if settings.torque_bound > 0.0:
        constraints.append(
            TorqueLimit(
                settings.torque_bound, model.na, settings.torque_bound_around, "torque_bound"
            )
        )
    if settings.rate_limit(robot) > 0.0:
        constraints.append(TorqueRateLimit(settings.rate_limit(robot), model.na))
    if settings.position_limits:
        constraints.append(
            JointPositionLimit(
                limits.position_lower, limits.position_upper, robot.brake_acceleration
            )
        )
    if settings.velocity_limits:
        limit = settings.velocity_limit or limits.velocity
        constraints.append(JointVelocityLimit(limit, model.na, settings.velocity_horizon))
    rate = settings.rate_limit(robot)
    planned = PlannedJerk(rate, model.na) if rate > 0.0 else None
    return ConstraintSet(constraints, model, planned)

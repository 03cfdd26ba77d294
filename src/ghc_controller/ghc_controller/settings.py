"""Settings of a controller beside the robot itself."""

from __future__ import annotations

import math
from collections.abc import Callable
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
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import DEFAULT_FORMULATION, FormulationSettings
from ghc_controller.registry import Registry
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
    constraints: tuple[str, ...] = ()  # further ones by name, such as those of plug-ins
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


# What makes a constraint of a robot under settings; None: it is off.
ConstraintFactory = Callable[[Robot, Settings], Constraint | None]

CONSTRAINTS: Registry[ConstraintFactory] = Registry("constraint", "ghc_controller.constraints")
# Decorator. Those registered here are made for every robot, in this order.
register_constraint = CONSTRAINTS.register


@register_constraint("torque_limit")
def _torque_limit(robot: Robot, _: Settings) -> Constraint:
    return TorqueLimit(robot.model.limits.torque, robot.model.na)


@register_constraint("torque_bound")
def _torque_bound(robot: Robot, settings: Settings) -> Constraint | None:
    if settings.torque_bound == 0.0:
        return None
    bound, around = settings.torque_bound, settings.torque_bound_around
    return TorqueLimit(bound, robot.model.na, around, "torque_bound")


@register_constraint("torque_rate")
def _torque_rate(robot: Robot, settings: Settings) -> Constraint | None:
    rate = settings.rate_limit(robot)
    return TorqueRateLimit(rate, robot.model.na) if rate > 0.0 else None


@register_constraint("joint_position")
def _joint_position(robot: Robot, settings: Settings) -> Constraint | None:
    if not settings.position_limits:
        return None
    limits = robot.model.limits
    return JointPositionLimit(
        limits.position_lower, limits.position_upper, robot.brake_acceleration
    )


@register_constraint("joint_velocity")
def _joint_velocity(robot: Robot, settings: Settings) -> Constraint | None:
    if not settings.velocity_limits:
        return None
    limit = settings.velocity_limit or robot.model.limits.velocity
    return JointVelocityLimit(limit, robot.model.na, settings.velocity_horizon)


_ALWAYS = CONSTRAINTS.built_in


def make_constraints(robot: Robot, settings: Settings) -> ConstraintSet:
    """Constraints of the robot under these settings (design, section 5).

    Raises:
        UnknownName: no constraint of a name in `settings.constraints`; lists those that exist.
        PluginError: a package brings it and it cannot be loaded.
    """
    names = dict.fromkeys((*_ALWAYS, *settings.constraints))
    made = [CONSTRAINTS[name](robot, settings) for name in names]
    return ConstraintSet([one for one in made if one is not None], robot.model)

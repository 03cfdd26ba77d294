"""Constraint generators: continuous bounds instead of steps. Public names.

Names are loaded on first use, as in `ghc_controller`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ghc_controller.migration.public_names import load_name

if TYPE_CHECKING:
    from ghc_mpc_constraints import bounds_generator, generator
    from ghc_mpc_constraints.generators import (
        body_margins,
        contact_forces,
        joint_limits,
        obstacle_motion,
        torque_limits,
    )
    from ghc_mpc_constraints.obstacle_motion import measurement
    from ghc_mpc_constraints.previews import horizon
    from ghc_mpc_constraints.schedules import contact_schedule, limit_schedule

    BodyMargins = body_margins.BodyMargins
    BodyMarginSettings = body_margins.BodyMarginSettings
    BoundsGenerator = bounds_generator.BoundsGenerator
    ContactForceBounds = contact_forces.ContactForceBounds
    ContactSchedule = contact_schedule.ContactSchedule
    ForceBoundSettings = contact_forces.ForceBoundSettings
    Generator = generator.Generator
    Horizon = horizon.Horizon
    JointLimits = joint_limits.JointLimits
    JointLimitSettings = joint_limits.JointLimitSettings
    LimitSchedule = limit_schedule.LimitSchedule
    MarginSchedule = body_margins.MarginSchedule
    Measurement = measurement.Measurement
    Measurements = obstacle_motion.Measurements
    ObstacleBounds = obstacle_motion.ObstacleBounds
    ObstacleSettings = obstacle_motion.ObstacleSettings
    Schedules = generator.Schedules
    Sensor = generator.Sensor
    TorqueLimits = torque_limits.TorqueLimits
    TorqueLimitSettings = torque_limits.TorqueLimitSettings
    register_generator = generator.register_generator

_HOMES = {
    "BodyMarginSettings": "generators.body_margins",
    "BodyMargins": "generators.body_margins",
    "BoundsGenerator": "bounds_generator",
    "ContactForceBounds": "generators.contact_forces",
    "ContactSchedule": "schedules.contact_schedule",
    "ForceBoundSettings": "generators.contact_forces",
    "Generator": "generator",
    "Horizon": "previews.horizon",
    "JointLimitSettings": "generators.joint_limits",
    "JointLimits": "generators.joint_limits",
    "LimitSchedule": "schedules.limit_schedule",
    "MarginSchedule": "generators.body_margins",
    "Measurement": "obstacle_motion.measurement",
    "Measurements": "generators.obstacle_motion",
    "ObstacleBounds": "generators.obstacle_motion",
    "ObstacleSettings": "generators.obstacle_motion",
    "Schedules": "generator",
    "Sensor": "generator",
    "TorqueLimitSettings": "generators.torque_limits",
    "TorqueLimits": "generators.torque_limits",
    "register_generator": "generator",
}
__all__ = [*_HOMES]


def __getattr__(name: str) -> object:
    return load_name(__name__, _HOMES, name)

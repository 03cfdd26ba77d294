"""Settings of a controller beside the robot itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.constraints import (
    Constraint,
    ConstraintSet,
    JointPositionLimit,
    JointVelocityLimit,
    ObstacleDistance,
    TorqueCenter,
    TorqueLimit,
    TorqueRateLimit,
)
from ghc_controller.constraints.planned_jerk import PlannedJerk
from ghc_controller.constraints.registry import CONSTRAINTS, is_kind, register_constraint
from ghc_controller.errors import InvalidValue
from ghc_controller.formulations import (
    DEFAULT_FORMULATION,
    FORMULATIONS,
    FormulationSettings,
    own_settings,
)
from ghc_controller.qp import SolverSettings
from ghc_controller.robot.robot import Robot
from ghc_controller.schema.declared import check, chosen_by, declared, inline
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE
from ghc_controller.schema.record import from_mapping, read
from ghc_controller.types import CONTROL_DT, Array


@dataclass(frozen=True, slots=True)
class Settings:
    """Numbers that a user may change without touching the robot's file.

    Parameters of the controller node and `parameters` of a scenario have the same names.

    Raises:
        InvalidValue: a number outside its range.
    """

    formulation: str = declared(", ".join(sorted(FORMULATIONS.built_in)), DEFAULT_FORMULATION)
    qp_solver: str = declared("daqp or proxqp", "daqp")
    solving: SolverSettings = inline(SolverSettings)
    control_dt: float = declared("control period", CONTROL_DT, unit="s", domain=POSITIVE)
    hierarchy: str = declared("hierarchy at the start; empty = of the robot's file", "")
    velocity_limit: float = declared(
        "of every joint; 0 = of the robot", 0.0, unit="rad/s", domain=NOT_NEGATIVE
    )
    velocity_horizon: float = declared(
        "over which velocity limits act; 0.01 to 0.05", 0.05, unit="s", domain=POSITIVE
    )
    torque_bound: float = declared(
        "of every joint; 0 = of the robot", 0.0, unit="Nm", domain=NOT_NEGATIVE
    )
    torque_bound_around: TorqueCenter = declared(
        "center of torque_bound: zero or gravity", TorqueCenter.ZERO
    )
    torque_rate_limit: float = declared(
        "rows and gate; 0 = off, negative = of the robot", -1.0, unit="Nm/s"
    )
    obstacle_horizon: float = declared(
        "over which an obstacle's distance is kept (delta t of eq. 4.2)",
        0.1,
        unit="s",
        domain=POSITIVE,
    )
    position_limits: bool = declared("keep joint positions in their range", True)
    velocity_limits: bool = declared("keep joint velocities below their limit", True)
    constraints: tuple[str, ...] = declared(
        "further constraints by name, such as those of plug-ins", ()
    )
    tuning_duration: float = declared(
        "of the blend by which gains, weights, limits and the formulation change while running",
        1.0,
        unit="s",
        domain=POSITIVE,
    )
    optimization: FormulationSettings = inline(FormulationSettings)
    own: Any = chosen_by("formulation", own_settings)  # what only the formulation in use has

    @classmethod
    def of(cls, **values: Any) -> Settings:
        """Settings by the names of parameters, also those of the formulation.

        Raises:
            ConfigurationError: an unknown name, or a value of another type or out of range.
        """
        return from_mapping(cls, values, "Settings.of")

    @classmethod
    def for_robot(cls, robot: Robot) -> Settings:
        """Defaults, but for what the section `settings` of robot.yaml says.

        Raises:
            ConfigurationError: file and field, what was given and expected.
        """
        return cls() if robot.settings is None else read(robot.settings, cls)

    def __post_init__(self) -> None:
        check(self)

    def rate_limit(self, robot: Robot) -> Array | float:
        """Torque rate limit in force [Nm/s], one number or (a,); 0 = off."""
        return robot.torque_rate if self.torque_rate_limit < 0.0 else self.torque_rate_limit


# What makes constraints of a robot under settings: functions (robot, settings) that return one, or
# None where it is off. Those registered here are made for every robot, in this order.


@register_constraint("torque_limit")
def _torque_limit(robot: Robot, _: Settings) -> Constraint:
    model = robot.model
    return TorqueLimit(model.limits.torque, model.na, follows=model.joint_names)


@register_constraint("torque_bound")
def _torque_bound(robot: Robot, settings: Settings) -> Constraint | None:
    if settings.torque_bound == 0.0:
        return None
    bound, around = settings.torque_bound, settings.torque_bound_around
    return TorqueLimit(bound, robot.model.na, around, "torque_bound")


@register_constraint("torque_rate")
def _torque_rate(robot: Robot, settings: Settings) -> Constraint | None:
    rate = settings.rate_limit(robot)
    return TorqueRateLimit(rate, robot.model.na) if np.max(rate) > 0.0 else None


@register_constraint("joint_position")
def _joint_position(robot: Robot, settings: Settings) -> Constraint | None:
    if not settings.position_limits:
        return None
    limits = robot.model.limits
    return JointPositionLimit(
        limits.position_lower,
        limits.position_upper,
        robot.brake_acceleration,
        joints=robot.model.joint_names,
    )


@register_constraint("joint_velocity")
def _joint_velocity(robot: Robot, settings: Settings) -> Constraint | None:
    if not settings.velocity_limits:
        return None
    limit = settings.velocity_limit or robot.model.limits.velocity
    return JointVelocityLimit(limit, robot.model.na, settings.velocity_horizon)


@register_constraint("obstacle_distance")
def _obstacle_distance(robot: Robot, settings: Settings) -> Constraint:
    return ObstacleDistance(robot.model, settings.obstacle_horizon)


_ALWAYS = tuple(name for name in CONSTRAINTS.built_in if not is_kind(CONSTRAINTS[name]))


def make_constraints(
    robot: Robot, settings: Settings, further: Sequence[Constraint] = ()
) -> ConstraintSet:
    """Constraints of the robot under these settings, then those of its file.

    Args:
        further: such as those of the forces of its contacts.

    Raises:
        UnknownName: no constraint of a name in `settings.constraints`; lists those that exist.
        PluginError: a package brings it and it cannot be loaded.
        InvalidValue: it has fields, or two constraints have one name.
    """
    names = dict.fromkeys((*_ALWAYS, *settings.constraints))
    for name in names:
        if is_kind(CONSTRAINTS[name]):
            raise InvalidValue(
                f"constraint '{name}' has fields: list it as a kind under 'constraints' in "
                "robot.yaml"
            )
    made = [CONSTRAINTS[name](robot, settings) for name in names]
    rate = settings.rate_limit(robot)
    planned = PlannedJerk(rate, robot.model.na) if np.max(rate) > 0.0 else None
    found = [one for one in made if one is not None]
    return ConstraintSet([*found, *robot.constraints, *further], robot.model, planned)

"""Constraints: rows on accelerations, torques and forces, one file a kind; see `constraint`."""

from ghc_controller.constraints.box import Box, Slack
from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Constraint,
    Rows,
    Softness,
    Space,
    Tick,
)
from ghc_controller.constraints.constraint_set import Boxes, ConstraintSet
from ghc_controller.constraints.joint_position import JointPositionLimit
from ghc_controller.constraints.joint_velocity import JointVelocityLimit
from ghc_controller.constraints.obstacle import ObstacleDistance
from ghc_controller.constraints.rows.distance import DistanceConstraint, Scalar
from ghc_controller.constraints.torque_limit import TorqueCenter, TorqueLimit
from ghc_controller.constraints.torque_rate import TorqueRateLimit

__all__ = [
    "Box",
    "BoxConstraint",
    "Boxes",
    "Constraint",
    "ConstraintSet",
    "DistanceConstraint",
    "JointPositionLimit",
    "JointVelocityLimit",
    "ObstacleDistance",
    "Rows",
    "Scalar",
    "Slack",
    "Softness",
    "Space",
    "Tick",
    "TorqueCenter",
    "TorqueLimit",
    "TorqueRateLimit",
]

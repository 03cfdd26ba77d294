"""Constraints: boxes on joint accelerations and torques, one file a kind; see `constraint`."""

from ghc_controller.constraints.box import Box, Slack
from ghc_controller.constraints.constraint import Constraint, Softness, Space, Tick
from ghc_controller.constraints.constraint_set import Boxes, ConstraintSet
from ghc_controller.constraints.joint_position import JointPositionLimit
from ghc_controller.constraints.joint_velocity import JointVelocityLimit
from ghc_controller.constraints.torque_limit import TorqueCenter, TorqueLimit
from ghc_controller.constraints.torque_rate import TorqueRateLimit

__all__ = [
    "Box",
    "Boxes",
    "Constraint",
    "ConstraintSet",
    "JointPositionLimit",
    "JointVelocityLimit",
    "Slack",
    "Softness",
    "Space",
    "Tick",
    "TorqueCenter",
    "TorqueLimit",
    "TorqueRateLimit",
]

"""Limits on joint accelerations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ghc_controller.constraints.constraint import (
    BoxConstraint,
    Softness,
    Space,
    Tick,
    positive_per_joint,
)
from ghc_controller.constraints.registry import ConstraintFields, register_constraint
from ghc_controller.errors import UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class JointAccelerationFields(ConstraintFields):
    """Fields of the kind `joint_acceleration`."""

    limit: float = declared("magnitude, of each joint", unit="rad/s^2", domain=POSITIVE)
    joints: tuple[str, ...] = declared(
        "joints that are limited; left out = every joint", (), names="joint", empty=False
    )


@register_constraint("joint_acceleration")
class JointAccelerationLimit(BoxConstraint):
    """-limit <= dv <= limit of some or all joints; relaxed like the velocity limit.

    It does not know of position limits: where `brake` of these needs more, the two conflict, and
    the one that is merged first is kept. Choose a limit above that `brake`.
    """

    entry = JointAccelerationFields
    space = Space.ACCELERATION
    softness = Softness.SOFT

    def __init__(
        self, name: str, model: RobotModel, limit: float, joints: Sequence[str] = ()
    ) -> None:
        """Limit [rad/s^2] of the named joints, none = all.

        Raises:
            UnknownName: of a joint. InvalidValue: `limit` is not positive.
        """
        super().__init__(name)
        self.limit = float(positive_per_joint(limit, 1, f"{name}, limit")[0])
        names = tuple(joints) or model.joint_names
        for joint in names:
            if joint not in model.joint_names:
                raise UnknownName("joint", joint, model.joint_names)
        first = model.nv - model.na
        self._places = np.array([first + model.joint_names.index(joint) for joint in names])

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> JointAccelerationLimit:
        """Build from one entry of `constraints` in robot.yaml."""
        given = read(fields, JointAccelerationFields, names={"joint": model.joint_names})
        return cls(given.name, model, given.limit, given.joints)

    def write(self, tick: Tick, lower: Array, upper: Array) -> None:  # noqa: ARG002
        """See BoxConstraint."""
        lower[self._places] = -self.limit
        upper[self._places] = self.limit

"""A coupling of joints: a weighted sum of their positions keeps in a range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.constraints.constraint import Tick
from ghc_controller.constraints.registry import ConstraintFields, register_constraint
from ghc_controller.constraints.rows.distance import DistanceConstraint, Scalar
from ghc_controller.errors import UnknownName
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read


def _coefficients(fields: Fields, name: str) -> dict[str, float]:
    given = fields.section(name)
    return {joint: given.number(joint) for joint in given.given()}


def _coefficients_schema(schema: Any) -> Any:
    return schema.mapping({"type": "number"})


@dataclass(frozen=True, slots=True, kw_only=True)
class JointCouplingFields(ConstraintFields):
    """Fields of the kind `joint_coupling`."""

    coefficients: Mapping[str, float] = declared(
        "joint: coefficient; others have none",
        unit="-",
        read=_coefficients,
        schema=_coefficients_schema,
    )
    lower: float = declared("of the sum; left out = none", -np.inf, unit="rad")
    upper: float = declared("of the sum; left out = none", np.inf, unit="rad")
    brake: float = declared("deceleration before a bound", 5.0, unit="rad/s^2", domain=POSITIVE)


@register_constraint("joint_coupling")
class JointCoupling(DistanceConstraint):
    """lower <= c^T q <= upper over the actuated joints."""

    entry = JointCouplingFields

    def __init__(
        self,
        name: str,
        model: RobotModel,
        coefficients: Mapping[str, float],
        lower: float = -np.inf,
        upper: float = np.inf,
        brake: float = 5.0,
    ) -> None:
        """Coefficients [-] by the names of joints; bounds [rad].

        Raises:
            UnknownName: of a joint. InvalidValue: a number out of range.
        """
        super().__init__(name, lower, upper, brake)
        self._row = np.zeros(model.nv)
        for joint, coefficient in coefficients.items():
            if joint not in model.joint_names:
                raise UnknownName("joint", joint, model.joint_names)
            self._row[model.nv - model.na + model.joint_names.index(joint)] = coefficient

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> JointCoupling:
        """Build from one entry of `constraints` in robot.yaml."""
        given = read(fields, JointCouplingFields)
        try:
            return cls(
                given.name, model, given.coefficients, given.lower, given.upper, given.brake
            )
        except UnknownName as error:
            raise fields.error("coefficients", str(error)) from error

    def measure(self, tick: Tick) -> Scalar:
        """The sum [rad]."""
        joints, model = self._row[tick.model.nv - tick.model.na :], tick.model
        return Scalar(
            float(joints @ model.q[-model.na :]), float(self._row @ model.v), self._row, 0.0
        )

"""A row constraint: the sum of all joint positions stays above a bound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.constraints import DistanceConstraint, Scalar, Tick
from ghc_controller.constraints.registry import ConstraintFields
from ghc_controller.model.robot_model import RobotModel
from ghc_controller.schema.declared import declared
from ghc_controller.schema.reader import Fields
from ghc_controller.schema.record import read


@dataclass(frozen=True, slots=True, kw_only=True)
class FoldGuardFields(ConstraintFields):
    """Fields of the kind `fold_guard`."""

    lower: float = declared("of the sum", unit="rad")


class FoldGuard(DistanceConstraint):
    """sum_i q_i >= lower."""

    entry = FoldGuardFields

    @classmethod
    def from_config(cls, fields: Fields, model: RobotModel) -> FoldGuard:  # noqa: ARG003
        """Build from one entry of `constraints` in robot.yaml."""
        given = read(fields, FoldGuardFields)
        return cls(given.name, given.lower, np.inf, brake=5.0)

    def measure(self, tick: Tick) -> Scalar:
        """The sum [rad]: J = (1, .., 1), without drift."""
        model = tick.model
        return Scalar(float(model.q.sum()), float(model.v.sum()), np.ones(model.nv), 0.0)

"""Limits of the actuated joints: read from the model, overridden by configuration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.types import Array

Limit = float | Mapping[str, float] | None  # of every joint, of some by name, of none


@dataclass(frozen=True, slots=True)
class JointLimits:
    """Symmetric limits are magnitudes; +-inf where a joint has none."""

    position_lower: Array  # (a,) [rad] or [m]
    position_upper: Array  # (a,) [rad] or [m]
    velocity: Array  # (a,) [rad/s] or [m/s]
    torque: Array  # (a,) [Nm] or [N]

    def copy(self) -> JointLimits:
        """The same limits in arrays of their own."""
        return JointLimits(
            self.position_lower.copy(),
            self.position_upper.copy(),
            self.velocity.copy(),
            self.torque.copy(),
        )


def overridden(
    values: Array,
    override: float | Mapping[str, float] | None,
    joint_names: tuple[str, ...],
    field: str,
) -> Array:
    """Copy of `values` with one number for every joint, or numbers for some joints by name.

    Raises:
        UnknownName: the mapping names a joint that does not exist.
        InvalidValue: a number is not finite and positive.
    """
    result = values.copy()
    if override is None:
        return result
    if not isinstance(override, Mapping):
        override = dict.fromkeys(joint_names, override)
    for name, value in override.items():
        if name not in joint_names:
            raise UnknownName("joint", name, joint_names)
        if not (np.isfinite(value) and value > 0.0):
            raise InvalidValue(f"{field} of '{name}': {value} given, a positive number expected")
        result[joint_names.index(name)] = value
    return result

"""One level of a hierarchy, linearized at a configuration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.errors import InvalidValue, WrongSize
from ghc_controller.types import Array


@dataclass(frozen=True, slots=True)
class LevelRows:
    """Rows lower <= J dq - w <= upper of eq. 19; equality rows have both bounds equal.

    Attributes:
        jacobian: (m, n).
        lower, upper: (m,) bound minus value now [m], [rad]; +-inf where there is none.
        equality: all rows are equalities; a level is either equality or inequality.

    Raises:
        WrongSize, InvalidValue: sizes differ, or a lower bound is above its upper bound or a
            Jacobian entry is not finite.
    """

    jacobian: Array
    lower: Array
    upper: Array
    equality: bool

    def __post_init__(self) -> None:
        m = len(self.jacobian)
        for name, bound in (("lower", self.lower), ("upper", self.upper)):
            if bound.shape != (m,):
                raise WrongSize(f"{name} bound of a level", bound.shape, (m,))
        if not (np.isfinite(self.jacobian).all() and (self.lower <= self.upper).all()):
            raise InvalidValue("level: finite Jacobian and lower <= upper expected")

    @classmethod
    def equalities(cls, jacobian: Array, error: Array) -> LevelRows:
        """Rows J dq = e, J (m, n), e (m,) = target - value."""
        return cls(jacobian, error, error, True)

    @property
    def violation(self) -> Array:
        """(m,) least change of the values that meets all rows: the error of equality rows."""
        return np.maximum(self.lower, 0.0) + np.minimum(self.upper, 0.0)

    @property
    def chain(self) -> Array:
        """(n,) 1 for coordinates on the kinematic chain (I* of eq. 18), else 0."""
        return (np.abs(self.jacobian).max(axis=0) > 1e-12).astype(np.float64)

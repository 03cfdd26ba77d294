"""Generators whose rows share one QP of independent lower and upper bounds (thesis, eq. 5.8)."""

from __future__ import annotations

from typing import Any

from ghc_controller.types import Array
from ghc_mpc_constraints.bounds_generator import BoundsGenerator
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundQp, ForceBoundWeights
from ghc_mpc_constraints.schedules.raw_bounds import RawBounds


class PlannedBounds(BoundsGenerator):
    """Bounds of every row over a receding horizon, with the same weights for all rows."""

    def __init__(self, settings: Any, weights: ForceBoundWeights) -> None:
        """Compute the constant matrices.

        Raises:
            InvalidValue: the horizon is not a multiple of the step.
        """
        super().__init__(settings)
        self._qp = ForceBoundQp(self.horizon, weights)

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._qp.second.asked

    def smooth(
        self,
        name: str,  # noqa: ARG002 - one QP for all rows
        time: float,  # noqa: ARG002
        first: tuple[float, float],
        raw: RawBounds,
    ) -> tuple[Array, Array] | None:
        """The optimum of eq. 5.8, lower and upper (N,) in the unit of the rows."""
        return self._qp.solve(first, raw.lower[1:], raw.upper[1:])

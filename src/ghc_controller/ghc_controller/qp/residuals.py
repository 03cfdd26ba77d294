"""KKT residuals of an answer: the solver's own status is not trusted."""

from __future__ import annotations

from typing import NamedTuple

from ghc_controller.core import native
from ghc_controller.qp.problem import QpProblem, QpResult
from ghc_controller.types import Array

VIOLATION_TOLERANCE = 1e-6  # [rad/s^2], [Nm], [N] of an accepted answer
RESIDUAL_TOLERANCE = 1e-7  # [-] of an accepted answer's stationarity
_GAP_TOLERANCE = 1e-6  # [-] of an accepted answer's cost
_ROUNDING_SHARE = 0.05  # of the violation: levels of a cascade add theirs up


class Residuals(NamedTuple):
    """KKT residuals of an answer (largest entry of each); NaN where the answer is not finite."""

    primal: float  # violation of the equalities and bounds, in the units of the rows
    dual: float  # stationarity
    complementarity: float  # multiplier times distance to its bound
    size: float  # 1 + the largest entry of the answer
    terms: float  # 1 + the largest term of the stationarity

    @property
    def relative(self) -> float:
        """Primal and dual residual, the larger one, over the size of the answer."""
        return max(self.primal, self.dual) / self.size

    @property
    def optimal(self) -> bool:
        """Whether the answer is stationary and its multipliers belong to active rows."""
        gap = _GAP_TOLERANCE * self.size * self.size
        return self.dual <= RESIDUAL_TOLERANCE * self.terms and self.complementarity <= gap

    @property
    def small(self) -> bool:
        """Whether the answer can be accepted: optimal, and no row violated."""
        return self.primal <= _ROUNDING_SHARE * VIOLATION_TOLERANCE and self.optimal


def residuals(problem: QpProblem, result: QpResult, units: Array | None = None) -> Residuals:
    """KKT residuals of `result`.

    Args:
        units: (r,) by which a violation of each inequality row is multiplied: the norms by which
            the rows were divided give it in rad/s^2, Nm and N. None: the rows as they are.
    """
    return Residuals(
        *native.kkt_residuals(
            problem.H,
            problem.g,
            problem.A,
            problem.b,
            problem.C,
            problem.l,
            problem.u,
            result.x,
            result.y,
            result.z,
            units,
        )
    )

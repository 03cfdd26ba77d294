"""KKT residuals of an answer: the solver's own status is not trusted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

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
        *_kkt_residuals(
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
            np.ones(problem.l.shape[0]) if units is None else units,
        )
    )


@njit(cache=True, fastmath={"reassoc", "contract", "nsz"})
def _row_times(row: Array, x: Array) -> float:  # pragma: no cover
    value = 0.0
    for c in range(row.shape[0]):
        value += row[c] * x[c]
    return value


@njit(cache=True)
def _kkt_residuals(
    hessian: Array,
    linear: Array,
    equalities: Array,
    right: Array,
    rows: Array,
    lower: Array,
    upper: Array,
    x: Array,
    y: Array,
    z: Array,
    units: Array,
) -> tuple[float, float, float, float, float]:  # pragma: no cover
    """Primal, dual, complementarity, 1 + max |x|, 1 + the largest term of the dual."""
    if not (np.isfinite(x).all() and np.isfinite(y).all() and np.isfinite(z).all()):
        return math.nan, math.nan, math.nan, 1.0, 1.0
    primal, dual, complementarity, size, terms = 0.0, 0.0, 0.0, 1.0, 1.0
    gradient = linear.copy()
    for c in range(x.shape[0]):
        value = _row_times(hessian[c], x)
        terms = max(terms, 1.0 + abs(gradient[c]), 1.0 + abs(value))
        gradient[c] += value
        size = max(size, 1.0 + abs(x[c]))
    for r in range(y.shape[0]):
        primal = max(primal, abs(_row_times(equalities[r], x) - right[r]))
        for c in range(x.shape[0]):
            gradient[c] += y[r] * equalities[r, c]
            terms = max(terms, 1.0 + abs(y[r] * equalities[r, c]))
    for r in range(z.shape[0]):
        value = _row_times(rows[r], x)
        primal = max(primal, units[r] * (lower[r] - value), units[r] * (value - upper[r]))
        if z[r] != 0.0:
            distance = upper[r] - value if z[r] > 0.0 else value - lower[r]
            complementarity = max(complementarity, abs(z[r] * distance))
            for c in range(x.shape[0]):
                gradient[c] += z[r] * rows[r, c]
                terms = max(terms, 1.0 + abs(z[r] * rows[r, c]))
    for c in range(x.shape[0]):
        dual = max(dual, abs(gradient[c]))
    return primal, dual, complementarity, size, terms

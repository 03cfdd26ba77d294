"""KKT residuals of an answer: not a word of the solver is trusted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from ghc_controller.qp.problem import QpProblem, QpResult
from ghc_controller.types import Array

RESIDUAL_TOLERANCE = 1e-7  # [-] relative residual up to which an answer is believed


class Residuals(NamedTuple):
    """KKT residuals of an answer (largest entry of each); NaN where the answer is not finite."""

    primal: float  # violation of the equalities and bounds
    dual: float  # stationarity
    complementarity: float  # multiplier times distance to its bound
    size: float  # 1 + the largest entry of the answer

    @property
    def relative(self) -> float:
        """Primal and dual residual, the larger one, over the size of the answer."""
        return max(self.primal, self.dual) / self.size

    @property
    def small(self) -> bool:
        """Whether the answer can be believed."""
        return self.relative <= RESIDUAL_TOLERANCE


def residuals(problem: QpProblem, result: QpResult) -> Residuals:
    """KKT residuals of `result`."""
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
) -> tuple[float, float, float, float]:  # pragma: no cover
    """Primal, dual, complementarity, 1 + max |x|."""
    if not (np.isfinite(x).all() and np.isfinite(y).all() and np.isfinite(z).all()):
        return math.nan, math.nan, math.nan, 1.0
    primal, dual, complementarity, size = 0.0, 0.0, 0.0, 1.0
    gradient = linear.copy()
    for c in range(x.shape[0]):
        gradient[c] += _row_times(hessian[c], x)
        size = max(size, 1.0 + abs(x[c]))
    for r in range(y.shape[0]):
        primal = max(primal, abs(_row_times(equalities[r], x) - right[r]))
        for c in range(x.shape[0]):
            gradient[c] += y[r] * equalities[r, c]
    for r in range(z.shape[0]):
        value = _row_times(rows[r], x)
        primal = max(primal, lower[r] - value, value - upper[r])
        if z[r] != 0.0:
            distance = upper[r] - value if z[r] > 0.0 else value - lower[r]
            complementarity = max(complementarity, abs(z[r] * distance))
            for c in range(x.shape[0]):
                gradient[c] += z[r] * rows[r, c]
    for c in range(x.shape[0]):
        dual = max(dual, abs(gradient[c]))
    return primal, dual, complementarity, size

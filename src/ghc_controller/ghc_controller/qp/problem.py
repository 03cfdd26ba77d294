"""A dense quadratic program in ProxSuite's letters, and what its solution must satisfy.

min  1/2 x^T H x + g^T x   subject to   A x = b,   l <= C x <= u
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ghc_controller.errors import WrongSize
from ghc_controller.types import Array

RESIDUAL_TOLERANCE = 1e-7  # [-] relative residual up to which an answer is believed


@dataclass(frozen=True, slots=True)
class QpProblem:
    """Data of one QP; n variables, e equalities, r inequality rows."""

    H: Array  # (n, n) symmetric, positive definite
    g: Array  # (n,)
    A: Array  # (e, n)
    b: Array  # (e,)
    C: Array  # (r, n)
    l: Array  # noqa: E741 - (r,) -inf where there is no bound
    u: Array  # (r,) +inf where there is no bound

    def check(self) -> None:
        """Raise WrongSize where shapes do not fit together."""
        n = self.g.shape[0]
        expected = {
            "H": (n, n),
            "A": (self.b.shape[0], n),
            "C": (self.l.shape[0], n),
            "u": self.l.shape,
        }
        for name, shape in expected.items():
            given = getattr(self, name).shape
            if given != shape:
                raise WrongSize(f"QP matrix {name}", given, shape)


class QpStatus(Enum):
    """How a solve ended."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    ITERATION_LIMIT = "iteration limit"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class QpResult:
    """Answer of a solver; multipliers satisfy H x + g + A^T y + C^T z = 0."""

    x: Array  # (n,)
    y: Array  # (e,) of the equalities
    z: Array  # (r,) of the inequalities; > 0 at the upper bound, < 0 at the lower one
    status: QpStatus
    iterations: int

    @property
    def found(self) -> bool:
        """True when the solver reports an optimum; `residuals` says whether it is one."""
        return self.status is QpStatus.SOLVED


@dataclass(frozen=True, slots=True)
class Residuals:
    """KKT residuals of an answer (largest entry of each)."""

    primal: float  # violation of the equalities and bounds
    dual: float  # stationarity
    complementarity: float  # multiplier times distance to its bound

    def relative(self, result: QpResult) -> float:
        """Primal and dual residual, the larger one, over the size of the answer."""
        size = 1.0 + float(np.max(np.abs(result.x), initial=0.0))
        return max(self.primal, self.dual) / size


def residuals(problem: QpProblem, result: QpResult) -> Residuals:
    """KKT residuals of `result`; not a word of the solver is trusted."""
    rows = problem.C @ result.x
    below, above = problem.l - rows, rows - problem.u
    gap = problem.A @ result.x - problem.b
    primal = max(
        np.max(below, initial=0.0), np.max(above, initial=0.0), np.max(np.abs(gap), initial=0.0)
    )
    gradient = problem.H @ result.x + problem.g + problem.A.T @ result.y + problem.C.T @ result.z
    slack = np.where(result.z > 0.0, -above, -below)
    slack = np.where(result.z == 0.0, 0.0, slack)
    return Residuals(
        float(primal),
        float(np.max(np.abs(gradient), initial=0.0)),
        float(np.max(np.abs(result.z * slack), initial=0.0)),
    )

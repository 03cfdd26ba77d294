"""A dense quadratic program in ProxSuite's letters, and its answer.

min  1/2 x^T H x + g^T x   subject to   A x = b,   l <= C x <= u
"""

from __future__ import annotations

import math
from enum import Enum
from typing import NamedTuple

import numpy as np

from ghc_controller.core import native
from ghc_controller.errors import WrongSize
from ghc_controller.types import Array

_NAMES = ("H", "g", "A", "b", "C", "l", "u")


class QpProblem(NamedTuple):
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

    def not_finite(self) -> str:
        """Name of the first entry of the QP that is not finite; "" where all can be used.

        A bound may be infinite on its own side.
        """
        found = native.qp_not_finite(*self)
        return "" if found < 0 else _NAMES[found]


class QpStatus(Enum):
    """How a solve ended."""

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    ITERATION_LIMIT = "iteration limit"
    FAILED = "failed"


class QpResult(NamedTuple):
    """Answer of a solver; multipliers satisfy H x + g + A^T y + C^T z = 0."""

    x: Array  # (n,)
    y: Array  # (e,) of the equalities
    z: Array  # (r,) of the inequalities; > 0 at the upper bound, < 0 at the lower one
    status: QpStatus
    iterations: int  # pivots, or inner iterations of ProxQP
    reason: str = ""  # in words, where no solver was called

    @property
    def found(self) -> bool:
        """True if the solver reports an optimum; check it with `residuals`."""
        return self.status is QpStatus.SOLVED

    @classmethod
    def without_answer(cls, problem: QpProblem, status: QpStatus, reason: str) -> QpResult:
        """Result of a solve that did not begin: NaN, and the reason."""
        x, y, z = (np.full_like(part, math.nan) for part in (problem.g, problem.b, problem.l))
        return cls(x, y, z, status, 0, reason)

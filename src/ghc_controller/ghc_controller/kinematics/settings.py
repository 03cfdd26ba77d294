"""Settings of the hierarchical least squares."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ghc_controller.errors import InvalidValue, UnknownName

MODELS = {
    "gn": "Gauss-Newton: no second-order term",
    "gn_qn": "Gauss-Newton, and BFGS with the structured secant on levels with a residual",
    "newton": "like gn_qn with the exact second-order term, its negative eigenvalues set to 0",
    "lm": "like gn_qn with the diagonal max(mu, 1/2 |e|^2) of eq. 18 instead of BFGS",
    "dhqp": "constant damping on every level (Herzog et al. 2016)",
    "adls": "damping near small singular values, equalities only, no bounds (Chiaverini 1997)",
}
SECOND_ORDER = ("gn_qn", "newton", "lm")


@dataclass(frozen=True, slots=True)
class KinematicSettings:
    """What a step minimizes, and how far it may go.

    Raises:
        UnknownName: no such model.
        InvalidValue: a number is not finite or out of range.
    """

    model: str = "gn_qn"
    trust_region: float = 0.01  # [rad], [m] Delta: bound on each |dq| per step
    adapts: bool = True  # shrink the trust region of joints that change sign (section V)
    switch: float = 1e-12  # [-] eps: 1/2 |w|^2 above which a level gets a second-order term
    least_damping: float = 1e-3  # [-] mu of eq. 18, 20
    damping: float = 2.0  # [-] lambda of dhqp, the largest of adls; its square weighs |dq|^2
    small_singular_value: float = 0.5  # [-] of adls: damping starts below
    rank_tolerance: float = 1e-7  # [-] of the largest singular value
    regularization: float = 1e-10  # [-] of every level, so that its answer is unique

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UnknownName("kinematic model", self.model, MODELS)
        for field in ("trust_region", "small_singular_value", "regularization"):
            self._check(field, above_zero=True)
        for field in ("switch", "least_damping", "damping", "rank_tolerance"):
            self._check(field, above_zero=False)

    def _check(self, field: str, above_zero: bool) -> None:
        value = getattr(self, field)
        if not (math.isfinite(value) and (value > 0.0 or (value == 0.0 and not above_zero))):
            least = "> 0" if above_zero else ">= 0"
            raise InvalidValue(f"{field}: {value} given, a number {least} expected")

"""Settings of the hierarchical least squares."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.errors import UnknownName
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE

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

    model: str = declared("one of MODELS", "gn_qn")
    trust_region: float = declared(
        "Delta: bound on each |dq| per step [rad], [m]", 0.01, domain=POSITIVE
    )
    adapts: bool = declared("shrink the trust region of joints that change sign (section V)", True)
    switch: float = declared(
        "eps: 1/2 |w|^2 above which a level gets a second-order term",
        1e-12,
        unit="-",
        domain=NOT_NEGATIVE,
    )
    least_damping: float = declared("mu of eq. 18, 20", 1e-3, unit="-", domain=NOT_NEGATIVE)
    damping: float = declared(
        "lambda of dhqp, the largest of adls; its square weighs |dq|^2",
        2.0,
        unit="-",
        domain=NOT_NEGATIVE,
    )
    small_singular_value: float = declared(
        "of adls: damping starts below", 0.5, unit="-", domain=POSITIVE
    )
    rank_tolerance: float = declared(
        "of the largest singular value", 1e-7, unit="-", domain=NOT_NEGATIVE
    )
    regularization: float = declared(
        "of every level, so that its answer is unique", 1e-10, unit="-", domain=POSITIVE
    )

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UnknownName("kinematic model", self.model, MODELS)
        check(self)

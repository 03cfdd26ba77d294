"""Settings of the generator of obstacle motion."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.schema.declared import check, declared, inline
from ghc_controller.schema.domains import NOT_NEGATIVE, POSITIVE
from ghc_mpc_constraints.obstacle_motion.approach import ReactionTime
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP
from ghc_mpc_constraints.previews.motion_weights import POWER


@dataclass(frozen=True, slots=True)
class ObstacleSettings:
    """Settings of the generator; T, N T and gamma are those of the thesis' figure 4.5.

    Raises:
        InvalidValue: a number outside its range.
    """

    step: float = STEP
    horizon: float = HORIZON
    jerk_weight: float = declared(
        "gamma of eq. 4.14; 1e-8 to 1e-4", 1e-5, unit="s^6", domain=POSITIVE
    )
    dynamic_weighting: bool = declared(
        "weighting matrix D of eq. 4.15, against overshoot; false: constant weight", True
    )
    power: float = declared(
        "g of eq. 4.16; the lowest weight is 10^-g", POWER, unit="-", domain=NOT_NEGATIVE
    )
    reaction: ReactionTime = inline(ReactionTime)
    margin: float = declared(
        "beyond the safe distance, where virtual obstacles enter and leave",
        0.05,
        unit="m",
        domain=NOT_NEGATIVE,
    )
    stale_after: float = declared(
        "without a message: obstacles are taken to be closer", 0.5, unit="s", domain=POSITIVE
    )
    stale_margin: float = declared(
        "by which they are taken to be closer", 0.05, unit="m", domain=NOT_NEGATIVE
    )
    smoothing: bool = SMOOTHING

    def __post_init__(self) -> None:
        check(self)

"""Generator of torque limits: continuous limits from schedules at each tick.

A step of a limit, such as the derating of a motor, would cause a torque step of a joint at its
limit. Each limit is smoothed like contact force bounds (thesis, eq. 5.6 to 5.8): one integrator
with a weight on its rate, so that the torque changes at this rate.
"""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.previews.preview import TORQUE_LIMITS
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_mpc_constraints.generator import Schedules, register_generator
from ghc_mpc_constraints.planned_bounds import PlannedBounds
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundWeights
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule


@dataclass(frozen=True, slots=True)
class TorqueLimitSettings:
    """Settings of the generator.

    Raises:
        InvalidValue: a number outside its range.
    """

    step: float = STEP
    horizon: float = HORIZON
    rate_weight: float = declared(
        "weight of the rate of both limits against their distance from the raw ones; 0.05 to 0.8",
        0.1,
        unit="s^2",
        domain=POSITIVE,
    )
    tighten_rate: float = declared(
        "towards the tightest limit ahead, without solution and preview",
        50.0,
        unit="Nm/s",
        domain=POSITIVE,
    )
    smoothing: bool = SMOOTHING

    def __post_init__(self) -> None:
        check(self)


@register_generator("torque_limits")
class TorqueLimits(PlannedBounds):
    """Both torque limits of every scheduled joint over a receding horizon."""

    kind = TORQUE_LIMITS
    settings_type = TorqueLimitSettings
    input = Schedules(
        "constraints/torque_limit_schedule", "ghc_msgs/LimitSchedule", LimitSchedule.read
    )

    def __init__(self, settings: TorqueLimitSettings) -> None:
        """Compute the constant matrices.

        Raises:
            InvalidValue: the horizon is not a multiple of the step.
        """
        super().__init__(settings, ForceBoundWeights(settings.rate_weight, settings.rate_weight))

"""Generator of torque limits: schedules of what motors may give in, moving limits out.

A limit that steps, as when a motor is derated, would step the torque of a joint that is at it.
Each limit is smoothed like the bounds of a contact force (thesis, eq. 5.6 to 5.8): a chain of one
integrator with a weight on its rate, so the torque of the joint changes at that rate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ghc_controller.previews.preview import TORQUE_LIMITS
from ghc_controller.schema.declared import check, declared
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array
from ghc_mpc_constraints.bounds_generator import BoundsGenerator
from ghc_mpc_constraints.generator import Schedules, register_generator
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundQp, ForceBoundWeights
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_mpc_constraints.schedules.raw_bounds import RawBounds


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
class TorqueLimits(BoundsGenerator):
    """Both torque limits of every scheduled joint over a receding horizon."""

    kind = TORQUE_LIMITS
    settings_type = TorqueLimitSettings
    input = Schedules(
        "constraints/torque_limit_schedule", "ghc_msgs/LimitSchedule", LimitSchedule.read
    )

    def __init__(self, settings: TorqueLimitSettings) -> None:
        """Make the constant matrices and compile.

        Raises:
            InvalidValue: a horizon that is no multiple of the step.
        """
        super().__init__(settings)
        weights = ForceBoundWeights(settings.rate_weight, settings.rate_weight)
        self._qp = ForceBoundQp(self.horizon, weights)
        ones = np.ones(self.horizon.steps)
        self._qp.solve((0.0, 2.0), 0.0 * ones, np.linspace(2.0, 1.0, len(ones)))

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._qp.second.asked

    def smooth(
        self,
        name: str,  # noqa: ARG002 - one QP for all joints
        time: float,  # noqa: ARG002
        first: tuple[float, float],
        raw: RawBounds,
    ) -> tuple[Array, Array] | None:
        """The optimum, lower and upper (N,) [Nm]."""
        return self._qp.solve(first, raw.lower[1:], raw.upper[1:])

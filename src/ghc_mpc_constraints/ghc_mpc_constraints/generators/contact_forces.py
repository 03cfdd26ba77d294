"""Generator of contact force bounds: continuous bounds from schedules at each tick."""

from __future__ import annotations

from dataclasses import dataclass

from ghc_controller.previews.preview import CONTACT_FORCES
from ghc_controller.schema.declared import check, declared, inline
from ghc_controller.schema.domains import POSITIVE
from ghc_mpc_constraints.generator import Schedules, register_generator
from ghc_mpc_constraints.planned_bounds import PlannedBounds
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundWeights
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP
from ghc_mpc_constraints.schedules.contact_schedule import ContactSchedule
from ghc_mpc_constraints.schedules.limit_schedule import LimitSchedule
from ghc_mpc_constraints.schedules.raw_bounds import RawBounds


@dataclass(frozen=True, slots=True)
class ForceBoundSettings:
    """Settings of the generator; the defaults are those of the thesis' figure 5.3.

    Raises:
        InvalidValue: a number outside its range.
    """

    step: float = STEP
    horizon: float = HORIZON
    weights: ForceBoundWeights = inline(ForceBoundWeights)
    tighten_rate: float = declared(
        "towards the tightest bound ahead, without solution and plan",
        50.0,
        unit="N/s",
        domain=POSITIVE,
    )
    smoothing: bool = SMOOTHING

    def __post_init__(self) -> None:
        check(self)


@register_generator("contact_forces")
@register_generator("contact_force_bounds")
class ContactForceBounds(PlannedBounds):
    """Both bounds of every contact over a receding horizon (eq. 5.6 to 5.8).

    As BoundsGenerator, but no bound of an active contact tightens to zero.
    """

    kind = CONTACT_FORCES
    settings_type = ForceBoundSettings
    input = Schedules(
        "constraints/contact_schedule",
        "ghc_msgs/ContactSchedule",
        ContactSchedule.read,
        "contacts",
    )

    def __init__(self, settings: ForceBoundSettings) -> None:
        """Compute the constant matrices.

        Raises:
            InvalidValue: the horizon is not a multiple of the step.
        """
        super().__init__(settings, settings.weights)

    def is_active(self, schedule: LimitSchedule, time: float) -> bool:
        """Whether the schedule allows a force at a time [s]."""
        return schedule.at(time)[1] > 0.0

    def floor(self, raw: RawBounds) -> tuple[float, float]:
        """The tightest upcoming bounds; an upper bound of an active contact is not set to zero."""
        ahead = raw.upper[raw.upper > 0.0]
        return float(raw.lower.max()), float(ahead.min()) if len(ahead) else 0.0

    def held(self, name: str, lower: float, upper: float) -> ContactSchedule:
        """Schedule of a contact that keeps its bounds [N]."""
        return ContactSchedule.checked(name, [0.0], [max(lower, 0.0)], [max(upper, 0.0)])

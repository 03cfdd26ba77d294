"""Generator of contact force bounds: schedules in, a plan of moving bounds out, tick by tick."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

from ghc_controller.previews.bounds_plan import ForceBoundsPlan, PlanStatus, bounds_at
from ghc_controller.schema.declared import check, declared, inline
from ghc_controller.schema.domains import POSITIVE
from ghc_controller.types import Array
from ghc_mpc_constraints.force_bounds.contact_schedule import ContactSchedule, RawBounds, preview
from ghc_mpc_constraints.previews.force_bound_qp import ForceBoundQp, ForceBoundWeights
from ghc_mpc_constraints.previews.horizon import HORIZON, SMOOTHING, STEP, STEP_TOLERANCE, Horizon


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


class ContactForceBounds:
    """Both bounds of every contact over a receding horizon (eq. 5.6 to 5.8).

    The first input of a plan is applied: the next tick starts where the plan before says. A
    contact starts on its raw bounds, or on those handed over by `take_over`. Without a solution
    the plan before is held as far as it goes, then the bounds tighten towards the tightest raw
    ones ahead; in no case is a bound looser than the raw one, and none of a contact that is on
    tightens to zero.
    """

    def __init__(self, settings: ForceBoundSettings) -> None:
        """Make the constant matrices and compile.

        Raises:
            InvalidValue: a horizon that is no multiple of the step.
        """
        self.settings = settings
        self.horizon = Horizon.of(settings.step, settings.horizon)
        self.counts: Counter[str] = Counter()
        self._qp = ForceBoundQp(self.horizon, settings.weights)
        self._schedules: dict[str, ContactSchedule] = {}
        self._handed_over: dict[str, tuple[float, float]] = {}
        self._plan: ForceBoundsPlan | None = None
        ones = np.ones(self.horizon.steps)
        self._qp.solve((0.0, 2.0), 0.0 * ones, np.linspace(2.0, 1.0, len(ones)))
        bounds_at(np.zeros((1, 2)), np.zeros((1, 2)), 0.0, True)

    @property
    def second_opinions(self) -> int:
        """How often the structured solve had to be repeated by another solver."""
        return self._qp.second.asked

    def set_schedule(self, schedule: ContactSchedule, now: float) -> None:
        """Use a schedule from its first time on; what was planned up to there stays."""
        old = self._schedules.get(schedule.contact)
        self._schedules[schedule.contact] = (
            schedule if old is None else old.followed_by(schedule, now)
        )

    def take_over(self, contact: str, lower: float, upper: float) -> None:
        """Start a contact from the bounds in force [N] instead of the raw ones.

        Has no effect on a contact that this generator has planned already.
        """
        if math.isfinite(lower) and math.isfinite(upper):
            self._handed_over[contact] = (lower, upper)

    def hold_handed_over(self) -> None:
        """Keep a contact that was taken over and has no schedule at its bounds in force.

        Without this the plan would leave it out, and what the robot's file says would hold at
        once. A schedule that comes later goes on from there.
        """
        for contact, (lower, upper) in self._handed_over.items():
            if contact not in self._schedules:
                self._schedules[contact] = ContactSchedule.checked(
                    contact, [0.0], [max(lower, 0.0)], [max(upper, 0.0)]
                )

    def reset(self) -> None:
        """Forget schedules, plans and bounds in force: time starts again.

        Schedules have to be set again: what was merged has lost its past.
        """
        self._schedules.clear()
        self._plan = None
        self._handed_over.clear()

    def tick(self, time: float) -> ForceBoundsPlan:
        """Plan from `time` [s]; asked again for the same time, the start is the same."""
        contacts = tuple(sorted(self._schedules))
        points = self.horizon.steps + 1
        lower, upper = np.empty((len(contacts), points)), np.empty((len(contacts), points))
        on, status, conflict = [], [], []
        for i, contact in enumerate(contacts):
            schedule = self._schedules[contact]
            raw = preview(schedule, time, self.horizon)
            on.append(schedule.at(time + STEP_TOLERANCE * self.horizon.step)[1] > 0.0)
            conflict.append(raw.conflict)
            status.append(self._plan_contact(contact, time, raw, lower[i], upper[i]))
            self.counts["conflicts"] += raw.conflict
            self.counts[status[-1].name.lower()] += 1
        self._plan = ForceBoundsPlan(
            time,
            self.horizon.step,
            contacts,
            lower,
            upper,
            tuple(on),
            tuple(status),
            tuple(conflict),
            self.settings.smoothing,
        )
        return self._plan

    def _plan_contact(
        self, contact: str, time: float, raw: RawBounds, lower: Array, upper: Array
    ) -> PlanStatus:
        """Write the bounds (N + 1,) of one contact."""
        if not self.settings.smoothing:
            lower[:], upper[:] = raw.lower, raw.upper
            return PlanStatus.RAW
        start = self._in_force(contact, time)
        lower[0], upper[0] = raw.lower[0], raw.upper[0]
        if start is not None:  # a late change may have left it outside the raw bounds
            upper[0] = min(max(start[1], raw.lower[0]), raw.upper[0])
            lower[0] = min(max(start[0], raw.lower[0]), upper[0])
        answer = self._qp.solve((lower[0], upper[0]), raw.lower[1:], raw.upper[1:])
        if answer is not None:
            lower[1:], upper[1:] = answer
            return PlanStatus.SMOOTHED
        return self._without_solution(contact, time, raw, lower, upper)

    def _in_force(self, contact: str, time: float) -> tuple[float, float] | None:
        """Bounds of the plan before at `time`, or those handed over."""
        plan = self._plan
        if plan is None or contact not in plan.contacts:
            return self._handed_over.get(contact)
        lower, upper = plan.at(time)
        index = plan.contacts.index(contact)
        return float(lower[index]), float(upper[index])

    def _without_solution(
        self, contact: str, time: float, raw: RawBounds, lower: Array, upper: Array
    ) -> PlanStatus:
        plan = self._plan
        held = plan is not None and contact in plan.contacts and time < plan.valid_until
        if held and plan is not None:
            index = plan.contacts.index(contact)
            for j, moment in enumerate(self.horizon.times(time)[1:], start=1):
                before = plan.at(moment)
                lower[j], upper[j] = before[0][index], before[1][index]
        else:
            ahead = raw.upper[raw.upper > 0.0]  # a contact that is on is not taken to zero
            ramp = self.settings.tighten_rate * self.horizon.step * np.arange(len(lower))
            floor = ahead.min() if len(ahead) else 0.0
            upper[:] = np.maximum(upper[0] - ramp, min(floor, upper[0]))
            lower[:] = np.minimum(lower[0] + ramp, max(raw.lower.max(), lower[0]))
        upper[:] = np.minimum(np.maximum(upper, raw.lower), raw.upper)
        lower[:] = np.minimum(np.maximum(lower, raw.lower), upper)
        return PlanStatus.HELD if held else PlanStatus.TIGHTENED

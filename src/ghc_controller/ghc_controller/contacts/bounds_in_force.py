"""Current normal force bounds: of the generator's plan, or of robot.yaml."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ghc_controller.contacts.contact import Contact, OnStale
from ghc_controller.contacts.normal_bounds import NormalBounds, Way
from ghc_controller.errors import InvalidValue, UnknownName
from ghc_controller.previews.preview import AGE_TOLERANCE, CONTACT_FORCES, Preview, StaleRule

_NOWHERE = np.zeros(0, dtype=np.intp)


class BoundsInForce:
    """Follows the newest plan; contacts missing from it keep the bounds of robot.yaml.

    After the end of a plan each contact holds its last bounds or is released, by the plan's stale
    rule or, with OF_ROBOT, by `on_stale` of the contact. A plan received after its start does not
    cause a jump of a bound that it loosens: see `Way`.
    Contacts are activated and deactivated by plans only: a contact that carries the robot is
    never deactivated because its generator timed out.

    Attributes:
        plan: the preview that is followed; None without.
    """

    kind = CONTACT_FORCES

    def __init__(self, contacts: Sequence[Contact]) -> None:
        self._contacts = tuple(contacts)
        self._names = [contact.name for contact in self._contacts]
        self._file = (
            np.array([contact.force_lower for contact in self._contacts]),
            np.array([contact.force_upper for contact in self._contacts]),
        )
        self.reset()

    def reset(self) -> None:
        """Discard the plan."""
        self.plan: Preview | None = None
        self._way: Way | None = None
        self._places = _NOWHERE
        self._held = _NOWHERE
        self._active = tuple(contact.active for contact in self._contacts)
        self._unplanned = self._planned(0.0)  # bounds while there is no plan

    def follow(self, plan: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """Use a plan for the contacts that the robot has.

        Args:
            plan: preview of a generator.
            now: [s] time from which it is followed; None = from its start.

        Returns:
            One message per ignored contact; empty if there are none.

        Raises:
            InvalidValue: a lower bound above `force_upper` of robot.yaml, or a bound that is NaN;
                the previous plan stays active.
        """
        if plan.motions:
            raise InvalidValue(f"{self.kind}: motions given, bounds of contacts expected")
        unknown = tuple(name for name in plan.rows if name not in self._names)
        if unknown:
            plan = plan.without(unknown)
        plan = self._within_file(plan)
        delay = 0.0 if now is None else now - plan.start
        in_force = None if now is None or delay <= AGE_TOLERANCE else self.at(now)
        self.plan = plan
        places = [self._names.index(name) for name in plan.rows]
        self._places = np.array(places, dtype=np.intp)
        of_robot = plan.stale is StaleRule.OF_ROBOT
        held = [
            self._contacts[place].on_stale is OnStale.HOLD
            if of_robot
            else plan.stale is not StaleRule.RELEASE
            for place in places
        ]
        self._held = np.flatnonzero(held)
        active = list(self._active)
        for place, on in zip(places, plan.active, strict=True):
            active[place] = on
        self._active = tuple(active)
        if not plan.interpolate:  # steps are intended
            self._way = None
        elif now is not None and in_force is not None:
            self._way = Way.begun(now, delay, in_force, self._planned(now), self._way)
        return tuple(UnknownName("contact", name, self._names) for name in unknown)

    def _within_file(self, plan: Preview) -> Preview:
        """The plan with upper bounds limited to `force_upper` of robot.yaml.

        Raises:
            InvalidValue: a lower bound above that, or a bound that is NaN.
        """
        if not plan.rows:
            return plan
        for name, bounds in (("lower", plan.lower), ("upper", plan.upper)):
            wrong = np.argwhere(np.isnan(bounds))
            if len(wrong):
                raise InvalidValue(
                    f"contact '{plan.rows[wrong[0, 0]]}', {name}: nan N given, a number expected"
                )
        most = self._file[1][[self._names.index(name) for name in plan.rows]]
        worst = plan.lower.max(axis=1)
        if (worst > most).any():
            c = int(np.argmax(worst - most))
            raise InvalidValue(
                f"contact '{plan.rows[c]}': lower bound {worst[c]:g} N given, at most "
                f"force_upper = {most[c]:g} N of the robot's file expected"
            )
        if (plan.upper.max(axis=1) > most).any():
            return replace(plan, upper=np.minimum(plan.upper, most[:, None]))
        return plan

    def at(self, time: float) -> NormalBounds:
        """Bounds at `time` [s]."""
        if self.plan is None or not self._contacts:
            return self._unplanned
        bounds = self._planned(time)
        if self._way is not None:
            self._way.narrow(time, bounds.lower, bounds.upper)
        return bounds

    @property
    def some_active(self) -> bool:
        """Whether a contact is on, by the plan or the robot's file."""
        return True in self._active

    def _planned(self, time: float) -> NormalBounds:
        lower, upper = self._file[0].copy(), self._file[1].copy()
        stale: tuple[str, ...] = ()
        plan = self.plan
        if plan is not None and plan.rows:
            values = plan.at(time)
            if plan.has_ended(time):
                stale, held = plan.rows, self._held
                lower[self._places[held]], upper[self._places[held]] = (
                    values[0][held],
                    values[1][held],
                )
            else:
                lower[self._places], upper[self._places] = values
        return NormalBounds(lower, upper, self._active, stale)

    def largest_ahead(self, place: int, time: float, span: float) -> float:
        """Largest planned upper bound [N] of a contact from `time` to `time + span` [s]."""
        plan = self.plan
        if plan is None or place not in self._places:
            return 0.0
        first = max(int(np.ceil((time - plan.start) / plan.step - 1e-6)), 0)
        last = int((time + span - plan.start) / plan.step + 1e-6)
        row = plan.upper[np.flatnonzero(self._places == place)[0], first : last + 1]
        return float(row.max(initial=0.0))

    @property
    def planned(self) -> tuple[str, ...]:
        """Contacts bounded by a generator, in the order of the plan."""
        return () if self.plan is None else self.plan.rows

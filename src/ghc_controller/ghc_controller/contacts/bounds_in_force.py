"""Which normal force bounds hold now: those of the generator's plan, or of the robot's file."""

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
    """Follows the newest plan; a contact that it leaves out keeps what the robot's file says.

    After the end of a plan each contact holds its last bounds or is released, as the plan's stale
    rule or, with OF_ROBOT, the contact's `on_stale` says. A plan that comes after its start does
    not make a bound jump that it loosens: see `Way`.
    Whether a contact is on does not change without a plan: one that carries the robot is
    never switched off because its generator is silent.
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
        """Forget the plan."""
        self._plan: Preview | None = None
        self._way: Way | None = None
        self._places = _NOWHERE
        self._held = _NOWHERE
        self._active = tuple(contact.active for contact in self._contacts)

    def follow(self, plan: Preview, now: float | None = None) -> tuple[UnknownName, ...]:
        """Take a plan over, as far as it speaks of contacts that the robot has.

        Args:
            plan: what a generator planned.
            now: [s] from when on it is followed; None = from its start.

        Returns:
            What is wrong with each contact that was left out; empty when none was.

        Raises:
            InvalidValue: a lower bound above what the robot's file allows; the plan before stays.
        """
        unknown = tuple(name for name in plan.rows if name not in self._names)
        if unknown:
            plan = plan.without(unknown)
        plan = self._within_file(plan)
        delay = 0.0 if now is None else now - plan.start
        in_force = None if now is None or delay <= AGE_TOLERANCE else self.at(now)
        self._plan = plan
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
        if not plan.interpolate:  # steps are what is asked for
            self._way = None
        elif now is not None and in_force is not None:
            self._way = Way.begun(now, delay, in_force, self._planned(now), self._way)
        return tuple(UnknownName("contact", name, self._names) for name in unknown)

    def _within_file(self, plan: Preview) -> Preview:
        """The plan with upper bounds of at most what the robot's file allows.

        Raises:
            InvalidValue: a lower bound above that.
        """
        if not plan.rows:
            return plan
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
        bounds = self._planned(time)
        if self._way is not None:
            self._way.narrow(time, bounds.lower, bounds.upper)
        return bounds

    def _planned(self, time: float) -> NormalBounds:
        lower, upper = self._file[0].copy(), self._file[1].copy()
        stale: tuple[str, ...] = ()
        plan = self._plan
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
        plan = self._plan
        if plan is None or place not in self._places:
            return 0.0
        first = max(int(np.ceil((time - plan.start) / plan.step - 1e-6)), 0)
        last = int((time + span - plan.start) / plan.step + 1e-6)
        row = plan.upper[np.flatnonzero(self._places == place)[0], first : last + 1]
        return float(row.max(initial=0.0))

    @property
    def planned(self) -> tuple[str, ...]:
        """Contacts that a generator has bounded, order of the plan."""
        return () if self._plan is None else self._plan.rows

"""What a contact feels decides with the schedule whether it is on: touches come early or late."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ghc_controller.contacts.bounds_in_force import BoundsInForce
from ghc_controller.contacts.contact import Contact
from ghc_controller.contacts.normal_bounds import NormalBounds
from ghc_controller.contacts.sensing_settings import Sensing
from ghc_controller.types import Array


@dataclass(slots=True)
class _Touch:
    """Memory of one contact."""

    on: bool
    since: float = -np.inf  # [s] when it was last switched on by a touch that came late
    early: bool = False  # it was switched on before its time, and that is still to come
    break_due: float = np.inf  # [s] first time at which the schedule had it off while it was on
    is_new: bool = True  # nothing was felt yet: a force then is none that has just come


class ContactSensing:
    """Confirms the schedule by the measured normal force, contact by contact.

    - A contact that the schedule switches on comes on when it is felt. Until then its task goes
      on, and lowers it when its reference does; afterwards its upper bound rises at `rise_rate`
      from `threshold`, about the force that its task pressed with, so that no force jumps. One
      that carries at the first look is on at once.
    - A touch up to `early` before its time switches it on at once. Where the planned bound still
      grants less, `threshold` is granted: the contact is kept still, and is not pressed further.
    - A break is carried out when the force has gone, at the latest after `patience`; not when the
      plan has ended because its generator is silent.

    Contacts without `sensing`, or without a measured wrench, follow the schedule alone.
    """

    def __init__(self, contacts: tuple[Contact, ...], bounds: BoundsInForce) -> None:
        self._contacts = contacts
        self._bounds = bounds
        self._is_used = any(contact.sensing is not None for contact in contacts)
        self.reset()

    def reset(self) -> None:
        """Forget what was felt."""
        self._touches = [_Touch(contact.active) for contact in self._contacts]

    def confirm(
        self, planned: NormalBounds, time: float, wrenches: Mapping[str, Array]
    ) -> NormalBounds:
        """Bounds with those contacts on that are felt to be; a repeated time changes nothing.

        Args:
            wrenches: name -> (6,) of the surroundings on the robot, world axes.
        """
        if not self._is_used:
            return planned
        active, upper = list(planned.active), planned.upper
        for k, contact in enumerate(self._contacts):
            wrench = wrenches.get(contact.name)
            if contact.sensing is None or wrench is None:
                self._touches[k].on = planned.active[k]
                continue
            felt = float(contact.axes[2] @ wrench[:3]) >= contact.sensing.threshold
            touch = self._touches[k]
            self._judge(k, touch, planned, felt, time)
            touch.is_new = False
            active[k] = touch.on
            if touch.on and touch.break_due == np.inf:
                upper = upper.copy()
                upper[k] = self._allowed(contact.sensing, touch, planned.upper[k], time)
        return replace(planned, active=tuple(active), upper=upper)

    @staticmethod
    def _allowed(sensing: Sensing, touch: _Touch, planned: float, time: float) -> float:
        """Upper bound [N] of a contact that is on, where it touched late or early."""
        if np.isfinite(touch.since):
            return min(planned, sensing.threshold + sensing.rise_rate * (time - touch.since))
        return max(planned, sensing.threshold) if touch.early else planned

    def _judge(
        self, k: int, touch: _Touch, planned: NormalBounds, felt: bool, time: float
    ) -> None:
        sensing = self._contacts[k].sensing
        assert sensing is not None
        if planned.active[k]:
            touch.break_due, touch.early = np.inf, False
            if not touch.on and felt:
                touch.on, touch.since = True, -np.inf if touch.is_new else time
        elif touch.on:
            if self._contacts[k].name in planned.stale:
                return  # its generator is silent: nobody asks for a break
            if touch.early and self._bounds.largest_ahead(k, time, sensing.early) > 0.0:
                return
            touch.break_due = min(touch.break_due, time)
            if not felt or time - touch.break_due >= sensing.patience:
                touch.on, touch.early = False, False
                touch.since, touch.break_due = -np.inf, np.inf
        elif felt and self._bounds.largest_ahead(k, time, sensing.early) > 0.0:
            touch.on, touch.early, touch.since = True, True, -np.inf

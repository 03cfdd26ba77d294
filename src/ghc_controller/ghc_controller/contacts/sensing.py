"""Contact detection: measured forces confirm the schedule, for early and late touch-downs."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
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
    since: float = -np.inf  # [s] of the last activation by a late touch-down
    early: bool = False  # activated before its scheduled time, which is still ahead
    break_due: float = np.inf  # [s] time of a scheduled lift-off while it is active
    is_new: bool = True  # no measurement yet: a force at first is not a touch-down


class ContactSensing:
    """Confirms the schedule by the measured normal force, contact by contact.

    - A scheduled contact is activated when it is detected. Until then its task stays active and
      keeps lowering it if its reference does; afterwards the upper bound rises at `rise_rate`
      from `threshold`, about the force with which the task pressed, so that no force jumps. A
      contact that carries a force at the first measurement is activated at once.
    - A touch-down up to `early` before its time activates the contact at once. Where the planned
      bound is lower, `threshold` applies: the contact is kept still and not pressed further.
    - A scheduled lift-off takes effect when the force is gone, at the latest after `patience`;
      not if the plan has ended because its generator timed out.

    Contacts without `sensing`, or without a measured wrench, follow the schedule alone.
    """

    def __init__(self, contacts: tuple[Contact, ...], bounds: BoundsInForce) -> None:
        self._contacts = contacts
        self._bounds = bounds
        self._is_used = any(contact.sensing is not None for contact in contacts)
        self.reset()

    def reset(self) -> None:
        """Reset the detection."""
        self._touches = [_Touch(contact.active) for contact in self._contacts]

    @property
    def is_used(self) -> bool:
        """Whether a contact is confirmed by what is felt."""
        return self._is_used

    def confirm(
        self, planned: NormalBounds, time: float, wrenches: Mapping[str, Array]
    ) -> NormalBounds:
        """Bounds with the detected contacts active; repeating a time changes nothing.

        Args:
            wrenches: name -> (6,) of the environment on the robot, world axes.
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

    def preview(
        self, planned: NormalBounds, time: float, wrenches: Mapping[str, Array]
    ) -> NormalBounds:
        """As `confirm`, and nothing is remembered: for a state that is not answered."""
        kept = [copy(touch) for touch in self._touches]
        try:
            return self.confirm(planned, time, wrenches)
        finally:
            self._touches = kept

    @staticmethod
    def _allowed(sensing: Sensing, touch: _Touch, planned: float, time: float) -> float:
        """Upper bound [N] of an active contact after a late or early touch-down."""
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
                return  # its generator has timed out: no lift-off is scheduled
            if touch.early and self._bounds.largest_ahead(k, time, sensing.early) > 0.0:
                return
            touch.break_due = min(touch.break_due, time)
            if not felt or time - touch.break_due >= sensing.patience:
                touch.on, touch.early = False, False
                touch.since, touch.break_due = -np.inf, np.inf
        elif felt and self._bounds.largest_ahead(k, time, sensing.early) > 0.0:
            touch.on, touch.early, touch.since = True, True, -np.inf

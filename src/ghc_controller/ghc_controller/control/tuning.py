"""Gains, weights, limits and formulation of a running controller, changed without a jump.

Numbers on which the torques depend continuously (`dials`) move to their new value; what is a
choice, such as the formulation, changes by blending the answers before and after it. Both follow
a quintic with rest at both ends, over `tuning_duration` seconds from the next step on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ghc_controller.control.change_checks import Change, ChangeChecks, Controller, settings_with
from ghc_controller.control.dials import WEIGHTS, Dial
from ghc_controller.control.handover import Handover
from ghc_controller.errors import InvalidValue
from ghc_controller.hierarchy.transition import Profile
from ghc_controller.safety.rate_anchor import HOLD_TIME
from ghc_controller.types import Array

_PROFILE = Profile.MINIMUM_JERK
_LATE = 2.5  # [-] control periods after which a step comes after a pause


@dataclass(slots=True)
class _Move:
    """Something on its way; `to(share)` puts it there and says whether it may end at 1."""

    to: Callable[[float], bool]
    duration: float  # [s]
    goal: Array | None = None  # of a dial
    begin: float | None = None  # [s]; None = at the next step


class Tuning:
    """Changes of one controller while it runs.

    Attributes:
        moves: what is on its way, by name; always the same object.
    """

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._checks = ChangeChecks(controller)
        self.moves: dict[str, _Move] = {}
        self._advanced = 0.0  # [s] of the last `advance` with something on its way

    @property
    def names(self) -> tuple[str, ...]:
        """What can be changed, by the names of parameters."""
        return self._checks.names

    def check(self, values: Mapping[str, Any]) -> Change:
        """What these values would change; nothing changes yet.

        Raises:
            UnknownName, ConfigurationError, InvalidValue: as ChangeChecks.check.
        """
        return self._checks.check(values, {name: move.goal for name, move in self.moves.items()})

    def begin(self, change: Change, duration: float | None = None) -> None:
        """Begin a checked change at the next step; before the first one it holds at once.

        Args:
            duration: [s] of the blend; None = `tuning_duration`.

        Raises:
            InvalidValue: a duration that is negative or not finite.
        """
        controller = self._controller
        settings = settings_with(change.given, controller.settings)
        span = settings.tuning_duration if duration is None else duration
        if not 0.0 <= span < math.inf:
            raise InvalidValue(
                f"duration = {span} s given, a finite number of at least 0 expected"
            )
        controller.settings = settings
        if change.formulation is not None:
            now = controller.formulation.settings
            change.formulation.retune(**{name: getattr(now, name) for name in WEIGHTS})
            dt = settings.control_dt
            handover = Handover(controller.formulation, change.formulation, dt)
            controller.formulation = handover
            self.moves["formulation"] = _Move(self._hand_over(handover), span)
        for name, dial, goal in change.goals:
            self.moves[name] = _Move(_between(dial, dial.read(), goal), span, goal)
        if not controller.has_stepped:
            self.finish()

    def advance(self, time: float) -> None:
        """Bring everything that is on its way to `time` [s].

        A time without steps does not count: after lost states, or while a fault was latched, what
        is on its way goes on from where it was.
        """
        if not self.moves:
            return
        paused, self._advanced = self._paused(time), time
        for name, move in tuple(self.moves.items()):
            if move.begin is not None:
                move.begin += paused
            else:
                move.begin = time
            passed = time - move.begin
            share = 1.0 if passed >= move.duration else _PROFILE.progress(passed / move.duration)
            if move.to(share) and share == 1.0:
                del self.moves[name]

    def _paused(self, time: float) -> float:
        """Time [s] since the last step that was no control period; 0 but for a pause."""
        period = self._controller.settings.control_dt
        passed = time - self._advanced
        if 0.0 <= passed <= max(HOLD_TIME, _LATE * period):
            return 0.0
        return passed - period

    def finish(self) -> None:
        """Put everything that is on its way where it goes."""
        for move in self.moves.values():
            move.to(1.0)
        self.moves.clear()
        if isinstance(self._controller.formulation, Handover):  # one that was not settled
            self._controller.formulation = self._controller.formulation.new

    def _hand_over(self, handover: Handover) -> Callable[[float], bool]:
        def to(share: float) -> bool:
            handover.share = share
            if share == 1.0 and handover.is_settled:
                self._controller.formulation = handover.new
            return handover.is_settled

        return to


def _between(dial: Dial, begin: Array, end: Array) -> Callable[[float], bool]:
    def to(share: float) -> bool:
        dial.write(end if share == 1.0 else _blended(begin, end, share))
        return True

    return to


def _blended(begin: Array, end: Array, share: float) -> Array:
    """Numbers on their way; from and to no limit, which is infinite, by their reciprocals."""
    finite = np.isfinite(begin) & np.isfinite(end)
    if finite.all():
        return begin + share * (end - begin)
    with np.errstate(divide="ignore", invalid="ignore"):
        linear = begin + share * (end - begin)
        return np.where(finite, linear, 1.0 / ((1.0 - share) / begin + share / end))

"""Reference torque of the rate limit: the one sent last, not the reported one.

On a robot the reported effort is a noisy measurement, and anyone on the network can forge it. It
is used only for the first torque, and only close to the holding torque. After a gap during which
the robot was held, the anchor is the holding torque, as close as the rate limit allows.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ghc_controller.core import Anchor
from ghc_controller.types import Array, RobotState

FIRST_SHARE = 0.1  # [-] of the torque limit: first report to holding torque
HOLD_TIME = 0.02  # [s] without commands, after which a bridge or driver holds the robot
_SAME_TIME = 1e-9  # [s]


class RateAnchor:
    """Stores the sent torques; gives the reference for the change of the next one.

    Two consecutive torques differ by at most the rate limit times the period, regardless of
    reported values in between.

    Attributes:
        core: the torques, where the core reads and stores them.
    """

    def __init__(
        self,
        torque_limit: Array,
        torque_step: Array,
        control_dt: float,
        floating_base: bool = False,
    ) -> None:
        """Nothing sent yet.

        Args:
            torque_limit: (a,) [Nm], inf where there is none.
            torque_step: (a,) [Nm] largest change in one control period; inf = no limit.
            control_dt: [s] control period.
            floating_base: the holding torque of such a robot is not known here: the first report
                is accepted within the torque limit, and after a hold the last sent torque is used.
        """
        self._floating_base = floating_base
        self._limit = torque_limit
        self._step = torque_step
        self._period = control_dt
        self.core = Anchor(np.inf if floating_base else HOLD_TIME)

    def reset(self) -> None:
        """Discard the sent torques."""
        self.core.forget()

    def sent(self, torque: Array, time: float) -> None:
        """Store the torque (a,) [Nm] that answers the state of `time` [s]; a copy of it."""
        self.core.note(torque, time)

    def before(self, state: RobotState, holding: Callable[[], Array]) -> Array:
        """Anchor (a,) [Nm] for the answer to a state.

        Args:
            holding: gives the torque (a,) [Nm] that holds the robot still at this state; called
                only if needed.
        """
        if not self.core.is_given:
            share = np.inf if self._floating_base else FIRST_SHARE
            return self.first(state.torque, holding(), share)
        if self._floating_base or not self.is_held(state.time):
            return self.at(state.time)
        return self.at(state.time, holding())

    def first(self, reported: Array | None, holding: Array, share: float = FIRST_SHARE) -> Array:
        """Anchor (a,) [Nm] for the first torque.

        Args:
            reported: (a,) [Nm] torque over the last period as the state has it, anything; what
                is not finite, as of a joint without an effort sensor, does not count.
            holding: (a,) [Nm] torque that holds the robot still at this state.
            share: [-] of the torque limit: largest distance of the report from `holding`.
        """
        anchor = holding
        if reported is not None:
            room = share * self._limit
            near = np.clip(reported, holding - room, holding + room)
            anchor = np.where(np.isfinite(reported), near, holding)
        before: Array = np.minimum(np.maximum(anchor, -self._limit), self._limit)
        self.core.before = before
        return before

    def is_held(self, time: float) -> bool:
        """Whether the gap before the state of `time` [s] was long enough for a hold."""
        return self.core.is_given and time - self.core.time > HOLD_TIME

    def follows(self, time: float) -> bool:
        """Whether `at(time)` is the anchor: a torque was sent, no hold came after it."""
        return self.core.is_given and (self._floating_base or time - self.core.time <= HOLD_TIME)

    def at(self, time: float, holding: Array | None = None) -> Array:
        """Anchor (a,) [Nm] for the answer to the state of `time` [s].

        Args:
            holding: (a,) [Nm] torque that holds the robot still, where `is_held`: the anchor is
                then as close to it as the rate limit allows.
        """
        core = self.core
        sent, before = core.sent, core.before
        assert sent is not None
        assert before is not None
        if abs(time - core.time) <= _SAME_TIME:
            return before  # a repeated state: do not start from its own answer
        before = sent
        if holding is not None and np.isfinite(holding).all():
            periods = round((time - core.time) / self._period) - 1
            room = periods * self._step if periods > 0 else 0.0  # 0 times no limit is no number
            before = np.clip(holding, sent - room, sent + room)
        core.before = before
        return before

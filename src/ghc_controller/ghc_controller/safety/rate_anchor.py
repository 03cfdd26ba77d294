"""From which torque the rate limit counts: the one that was sent, not the one that is reported.

On a robot the reported effort is a noisy measurement, and anybody on the network can forge it. It
is used for the first torque alone, and only near what holds the robot still. After a silence in
which the robot was held, the anchor is the holding torque, as near as the rate limit leads.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ghc_controller.types import Array, RobotState

FIRST_SHARE = 0.1  # [-] of the torque limit: how far a first report may be from holding still
HOLD_TIME = 0.02  # [s] of silence, after which a bridge or driver holds the robot
_SAME_TIME = 1e-9  # [s]


class RateAnchor:
    """Remembers what was sent; says from where the next torque may change.

    Two torques sent in a row differ by at most the rate limit times the period, whatever is
    reported in between.
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
            floating_base: how such a robot is held is not known here: the first report is
                believed within the torque limit, and after a hold it goes on from what was sent.
        """
        self._floating_base = floating_base
        self._limit = torque_limit
        self._step = torque_step
        self._period = control_dt
        self.reset()

    def reset(self) -> None:
        """Forget what was sent."""
        self._sent: Array | None = None
        self._time = 0.0  # [s] of the state that `_sent` answers
        self._before: Array | None = None  # [Nm] anchor that was used for it

    def sent(self, torque: Array, time: float) -> None:
        """Note the torque (a,) [Nm] that answers the state of `time` [s]."""
        self._sent, self._time = torque, time

    def before(self, state: RobotState, holding: Callable[[], Array]) -> Array:
        """Anchor (a,) [Nm] for the answer to a state.

        Args:
            holding: gives the torque (a,) [Nm] that holds the robot still at this state; called
                only where it is needed.
        """
        if self._sent is None:
            share = np.inf if self._floating_base else FIRST_SHARE
            return self.first(state.torque, holding(), share)
        if self._floating_base or not self.is_held(state.time):
            return self.at(state.time)
        return self.at(state.time, holding())

    def first(self, reported: Array | None, holding: Array, share: float = FIRST_SHARE) -> Array:
        """Anchor (a,) [Nm] for the first torque.

        Args:
            reported: (a,) [Nm] torque over the last period as the state has it, anything.
            holding: (a,) [Nm] torque that holds the robot still at this state.
            share: [-] of the torque limit that the report may be away from `holding`.
        """
        anchor = holding
        if reported is not None and np.isfinite(reported).all():
            room = share * self._limit
            anchor = np.clip(reported, holding - room, holding + room)
        self._before = np.clip(anchor, -self._limit, self._limit)
        return self._before

    def is_held(self, time: float) -> bool:
        """Whether the silence before the state of `time` [s] was long enough for a hold."""
        return self._sent is not None and time - self._time > HOLD_TIME

    def at(self, time: float, holding: Array | None = None) -> Array:
        """Anchor (a,) [Nm] for the answer to the state of `time` [s].

        Args:
            holding: (a,) [Nm] torque that holds the robot still, where `is_held`: the anchor is
                then as near to it as the rate limit could have led meanwhile.
        """
        assert self._sent is not None
        assert self._before is not None
        if abs(time - self._time) <= _SAME_TIME:
            return self._before  # a state that is answered again: not from its own answer
        self._before = self._sent
        if holding is not None and np.isfinite(holding).all():
            room = max(round((time - self._time) / self._period) - 1, 0) * self._step
            self._before = np.clip(holding, self._sent - room, self._sent + room)
        return self._before
